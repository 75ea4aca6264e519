// The lanes engine: many environments at once, one per float lane of the processor's vector unit.
//
// Contacts are points of rounded cores (sim/lanes/hand_cores.h) on the object's distance field
// (sim/lanes/object_field.h). State is float32. Results are the same for any number of workers and
// any place of an environment in the batch; they differ between instruction sets in the last bits,
// which a few hundred steps of contact grow to visible differences.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sim/batch_sim.h"

namespace dexremoe {

// As MakeBatchSim. Throws Error when the hand has more joints or fingers than a block has room for,
// a mass or inertia is not positive, or options.instructions names a set that the processor lacks.
std::unique_ptr<BatchSim> MakeLanesSim(const SimOptions& options, const HandModel& hand,
                                       std::vector<SimObject> objects, int num_envs,
                                       ThreadPool& pool);

// The instruction sets that this processor runs, fastest first: avx512, avx2, sse4, portable.
std::vector<std::string> LaneInstructions();

// What a run's memory and time went to.
struct LanesFootprint {
  std::size_t bytes_per_env = 0;     // state in the blocks
  std::size_t bytes_per_object = 0;  // its distance field
  int lanes = 0;                     // environments of a block
  std::string instructions;
};
struct LanesProfile {
  // Share of the kernels' time, summing to 1: names and shares by phase.
  std::vector<std::string> phases;
  std::vector<double> shares;
  double slots = 0;      // contact slots that a vector of lanes solves in a substep
  double occupancy = 0;  // share of the lanes of those slots that have a contact in them
};

// Of a simulator that MakeLanesSim made; throws Error for another engine's.
LanesFootprint FootprintOf(const BatchSim& sim);
// Switches measuring on, and off again with the shares since.
void StartProfile(BatchSim& sim);
LanesProfile StopProfile(BatchSim& sim);

}  // namespace dexremoe
