// What train_base, train_expert and train_gate have in common: objects in, checkpoint out.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/options.h"
#include "hand/hand_model.h"
#include "rl/communicator.h"
#include "rl/ppo_options.h"
#include "rl/start.h"
#include "rl/train_state.h"
#include "sim/batch_sim.h"
#include "task/reorient.h"

namespace dexremoe {

struct StageOptions {
  std::string objects;  // objects.csv
  std::string out;
  std::string best;         // empty: beside `out`
  std::string curve;        // CSV; empty for none
  std::string tensorboard;  // folder of event files; empty for none
  std::string snapshots;    // folder of states on the way; empty for none
  double snapshot_samples = 5e6;
  double samples = 0;
  std::uint64_t seed = 1;
  int workers = 0;
  bool resume = false;
  double checkpoint_minutes = 2;
  HandOptions hand;
  SimOptions sim;
  TaskOptions task;
  PpoOptions ppo;
  AdrOptions adr;  // registered by the tool that offers it
  void Register(Options& options);
};

// What sets the stages apart.
struct StageKind {
  std::vector<std::string> categories;  // objects to train on; empty for all
  std::vector<std::string> inputs;      // checkpoints it starts from
  std::string first_object;             // put first of the list; empty: as listed
  int cloud_points = 0;                 // of the policy's structure
  // The first state; the sizes are those of the environments.
  std::function<TrainState(const StageStart& start, int obs_size, int phys_size, int num_actions)>
      start;
};

// Trains on the objects of split "train" until `samples` environment steps are done; writes --out,
// the best state beside it (see Trainer::improved) and --curve every checkpoint_minutes and at the
// end, the events of --tensorboard at every iteration. When `stop` turns true, finishes the
// iteration, writes all and throws Error that says how to resume. Throws Error on bad input.
// With several ranks each trains on its share of the environments, and rank 0 writes the files.
// Returns the final state, without the environments' bytes.
TrainState RunStage(const StageOptions& stage, const Options& options, const StageKind& kind,
                    Communicator& ranks, const std::atomic<bool>& stop);

// One line for people: "base.h5: 2000000 samples, ...".
std::string StageSummary(const StageOptions& stage, const TrainState& state);

}  // namespace dexremoe
