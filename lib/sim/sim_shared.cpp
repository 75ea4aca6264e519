#include "sim/sim_shared.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/error.h"

namespace dexremoe {
namespace {

bool AllFinite(std::span<const double> values) {
  // A sum of finite numbers may overflow, but then each is looked at.
  double sum = 0;
  for (const double v : values) sum += v;
  return std::isfinite(sum) ||
         std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

bool MayTouch(const HandModel& hand, const Collider& a, const Collider& b) {
  if (!a.fingertip) return false;
  if (b.fingertip) return hand.links[a.link].chain < hand.links[b.link].chain;
  return b.link == 0 && hand.links[a.link].parent != 0;
}

}  // namespace

SimState SizedState(int num_envs, const HandModel& hand) {
  const std::size_t n = num_envs, joints = hand.num_joints();
  SimState state;
  state.joint_position.resize(n * joints);
  state.joint_velocity.resize(n * joints);
  state.object_position.resize(n * 3);
  state.object_rotation.resize(n * 4);
  state.object_velocity.resize(n * 3);
  state.object_spin.resize(n * 3);
  state.tip_contact.resize(n * hand.chains.size());
  state.contact_count.resize(n);
  state.max_penetration.resize(n);
  return state;
}

void CheckRow(const SimState& state, int env, std::int64_t step) {
  const auto check = [&](const std::vector<double>& values, std::size_t width, const char* field) {
    if (!AllFinite({values.data() + env * width, width}))
      Fail("environment {}: step {}: {}: expected finite numbers (unstable simulation?)", env, step,
           field);
  };
  const std::size_t joints = state.joint_position.size() / state.contact_count.size();
  check(state.joint_position, joints, "joint_position");
  check(state.joint_velocity, joints, "joint_velocity");
  check(state.object_position, 3, "object_position");
  check(state.object_rotation, 4, "object_rotation");
  check(state.object_velocity, 3, "object_velocity");
  check(state.object_spin, 3, "object_spin");
}

void CheckObject(int env, int object, std::size_t num_objects) {
  if (object < 0 || object >= static_cast<int>(num_objects))
    Fail("environment {}: object: expected 0..{}, found {}", env, num_objects - 1, object);
}

void CheckStateToSet(int env, const EnvState& state, int num_joints) {
  DEX_CHECK_EQ(static_cast<int>(state.q.size()), num_joints);
  DEX_CHECK_EQ(state.qd.size(), state.q.size());
  if (!AllFinite(state.q) || !AllFinite(state.qd) || !state.X_WO.p.allFinite() ||
      !state.X_WO.q.coeffs().allFinite() || !state.v.allFinite() || !state.w.allFinite())
    Fail("environment {}: state to set: expected finite numbers", env);
}

void CheckTargets(std::span<const double> targets, std::span<const std::uint8_t> active,
                  const BatchSim& sim, std::span<const std::int64_t> steps) {
  const std::size_t n = sim.num_envs(), joints = sim.num_joints();
  DEX_CHECK_EQ(targets.size(), n * joints);
  if (!active.empty()) DEX_CHECK_EQ(active.size(), n);
  for (std::size_t env = 0; env < n; ++env)
    if ((active.empty() || active[env]) && !AllFinite(targets.subspan(env * joints, joints)))
      Fail("environment {}: step {}: target: expected finite angles", env, steps[env]);
}

std::vector<std::array<int, 2>> SelfContactPairs(const HandModel& hand) {
  std::vector<std::array<int, 2>> pairs;
  const int count = static_cast<int>(hand.colliders.size());
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < count; ++j)
      if (i != j && MayTouch(hand, hand.colliders[i], hand.colliders[j])) pairs.push_back({i, j});
  return pairs;
}

PhysicsNumbers NumbersOf(const EnvPhysics& p) {
  return {p.mass,        p.com.x(),     p.com.y(),     p.com.z(),
          p.friction,    p.scale,       p.kp_factor,   p.kd_factor,
          p.gravity.x(), p.gravity.y(), p.gravity.z(), p.torsional_friction};
}

EnvPhysics PhysicsOf(const PhysicsNumbers& n) {
  EnvPhysics physics;
  physics.mass = n[0];
  physics.com = {n[1], n[2], n[3]};
  physics.friction = n[4];
  physics.scale = n[5];
  physics.kp_factor = n[6];
  physics.kd_factor = n[7];
  physics.gravity = {n[8], n[9], n[10]};
  physics.torsional_friction = n[11];
  return physics;
}

}  // namespace dexremoe
