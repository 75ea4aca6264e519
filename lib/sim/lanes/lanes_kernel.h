// The step of a block, compiled once for every instruction set.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/lanes/lanes_model.h"

namespace dexremoe {

enum LanesPhase { kDynamicsPhase, kFieldPhase, kSetUpPhase, kSolvePhase, kFinishPhase, kPhases };

// Ticks of the processor's clock spent in each phase.
using PhaseTicks = std::array<std::uint64_t, kPhases>;

// Advances all lanes of a block by one control step. block: [layout.rows][kBlockLanes], aligned to
// 64 bytes. `ticks` may be null.
using StepBlockFunction = void (*)(const LanesModel& model, float* block, PhaseTicks* ticks);

struct LanesKernel {
  std::string name;  // avx512, avx2, sse4, portable
  StepBlockFunction step;
};

// What this processor runs, fastest first.
std::vector<LanesKernel> LanesKernels();

}  // namespace dexremoe
