// The step of a block, compiled once for every instruction set.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/lanes/lanes_model.h"

namespace dexremoe {

enum LanesPhase { kDynamicsPhase, kFieldPhase, kSetUpPhase, kSolvePhase, kFinishPhase, kPhases };

// What a run did, summed over steps of (passes over) blocks.
struct KernelCounts {
  std::array<std::uint64_t, kPhases> ticks{};  // of the processor's clock, by phase
  std::uint64_t substeps = 0;                  // of a vector of lanes
  std::uint64_t slots = 0;                     // contact slots solved: used by any lane
  std::uint64_t points = 0;                    // contact points in them, over the lanes
  std::uint64_t lanes = 0;                     // lanes of those slots, busy or not

  void Add(const KernelCounts& other) {
    for (int phase = 0; phase < kPhases; ++phase) ticks[phase] += other.ticks[phase];
    substeps += other.substeps;
    slots += other.slots;
    points += other.points;
    lanes += other.lanes;
  }
};

// Advances all lanes of a block by one control step. block: [layout.rows][kBlockLanes], aligned to
// 64 bytes. `counts` may be null.
using StepBlockFunction = void (*)(const LanesModel& model, float* block, KernelCounts* counts);

struct LanesKernel {
  std::string name;  // avx512, avx2, sse4, portable
  StepBlockFunction step;
};

// What this processor runs, fastest first.
std::vector<LanesKernel> LanesKernels();

}  // namespace dexremoe
