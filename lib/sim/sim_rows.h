// What every engine does with the rows of SimState and the arguments of BatchSim.
#pragma once

#include <cstdint>
#include <span>

#include "sim/batch_sim.h"

namespace dexremoe {

// Arrays of the right sizes, filled with zeros.
SimState SizedState(int num_envs, const HandModel& hand);

// Throws Error naming environment, step and field when a number in row `env` is not finite.
void CheckRow(const SimState& state, int env, std::int64_t step);

// Throws Error naming environment and field.
void CheckObject(int env, int object, std::size_t num_objects);
void CheckStateToSet(int env, const EnvState& state, int num_joints);
void CheckTargets(std::span<const double> targets, std::span<const std::uint8_t> active,
                  const BatchSim& sim, std::span<const std::int64_t> steps);

}  // namespace dexremoe
