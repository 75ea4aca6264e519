// The first state of each training stage (paper, III-C to III-E).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "policy/structure.h"
#include "rl/ppo_options.h"
#include "rl/train_state.h"

namespace dexremoe {

// What every stage is started with.
struct StageStart {
  PpoOptions ppo;
  TaskDifficulty task;  // what a curriculum ends at
  ShapeTable table;     // the objects trained on
  std::uint64_t seed = 0;
};

// A fresh network; the moments of the descriptors are those of the table.
TrainState StartBase(const StageStart& start, const PolicyOptions& policy, int obs_size,
                     int phys_size, int num_actions);

// The same for any structure that is trained from scratch; `stage` is its name.
TrainState StartFresh(const StageStart& start, const PolicyOptions& policy,
                      const PolicyStructure& structure, const std::string& stage);

// A residual over the frozen base; the base's samples count as its own. Throws Error naming `path`
// when `base` is a mixture.
TrainState StartResidual(const StageStart& start, const PolicyOptions& policy,
                         const TrainState& base, const std::string& path);

// The base itself, to be trained on: network, optimiser, moments, curriculum, curve and samples.
// Throws Error naming `path` when `base` is a mixture or knew other objects.
TrainState ContinueBase(const StageStart& start, const TrainState& base, const std::string& path);

// A copy of the base (or of another expert) with frozen encoders and input moments, and a fresh
// optimiser. Throws Error naming `path` when `base` is a mixture.
TrainState StartExpert(const StageStart& start, const TrainState& base, const std::string& path);

// The mixture of the experts. Throws Error naming the file and field when they do not share
// encoders, input moments and widths.
TrainState StartGate(const StageStart& start, const PolicyOptions& policy,
                     const std::vector<TrainState>& experts, const std::vector<std::string>& paths);

}  // namespace dexremoe
