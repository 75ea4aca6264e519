// What the engines share: rows of SimState, checks of arguments, which colliders may touch.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

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

// Pairs of hand colliders that may touch: fingertips of different fingers (the lower finger first),
// and a tip and the palm unless the tip hangs on the palm. Links next to each other never do.
std::vector<std::array<int, 2>> SelfContactPairs(const HandModel& hand);

// Physical parameters as plain numbers, for saved states.
using PhysicsNumbers = std::array<double, 12>;
PhysicsNumbers NumbersOf(const EnvPhysics& physics);
EnvPhysics PhysicsOf(const PhysicsNumbers& numbers);

}  // namespace dexremoe
