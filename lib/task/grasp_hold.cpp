#include "task/grasp_hold.h"

#include <algorithm>

#include "base/check.h"
#include "task/rotation.h"

namespace dexremoe::internal {
namespace {

Eigen::Vector3d PositionOf(const SimState& state, int env) {
  return Eigen::Vector3d(&state.object_position[3 * static_cast<std::size_t>(env)]);
}

Eigen::Quaterniond RotationOf(const SimState& state, int env) {
  const double* q = &state.object_rotation[4 * static_cast<std::size_t>(env)];
  return {q[0], q[1], q[2], q[3]};
}

SimOptions CertifyingOptions(const GraspOptions& options, SimOptions sim) {
  sim.engine = options.certify;
  sim.substeps = options.certify_substeps;
  return sim;
}

}  // namespace

bool HoldRule::Touches(const SimState& state, int env, std::size_t finger) const {
  return state.tip_contact[env * hand_.chains.size() + finger] != 0;
}

bool HoldRule::Gripped(const SimState& state, int env) const {
  bool other = false;
  for (std::size_t f = 1; f < hand_.chains.size(); ++f) other = other || Touches(state, env, f);
  return Touches(state, env, 0) && other;
}

bool HoldRule::Near(const SimState& state, int env) const {
  const Eigen::Vector3d center(task_.grasp_center.data());
  return (PositionOf(state, env) - center).norm() <= options_.max_distance;
}

bool HoldRule::AtRest(const SimState& before, const SimState& now, int env) const {
  const double moved = (PositionOf(now, env) - PositionOf(before, env)).norm();
  const double turned = RotationDistance(RotationOf(now, env), RotationOf(before, env));
  return moved * control_rate_ <= options_.max_speed && turned * control_rate_ <= options_.max_spin;
}

Certifier::Certifier(const GraspOptions& options, const TaskOptions& task, const SimOptions& sim,
                     const HandModel& hand, const SimObject& object, int capacity, ThreadPool& pool)
    : options_(options),
      joints_(hand.num_joints()),
      rule_(options, task, hand, sim.control_rate),
      sim_(MakeBatchSim(CertifyingOptions(options, sim), hand, {object}, capacity, pool)) {}

std::vector<std::uint8_t> Certifier::Certify(std::span<const FoundGrasp> found) {
  const std::size_t n = found.size();
  DEX_CHECK_LE(n, static_cast<std::size_t>(sim_->num_envs()));
  std::vector<std::uint8_t> active(sim_->num_envs(), 0);
  std::vector<double> targets(static_cast<std::size_t>(sim_->num_envs()) * joints_, 0.0);
  for (std::size_t env = 0; env < n; ++env) {
    const Grasp& grasp = found[env].grasp;
    sim_->SetObject(env, 0, found[env].physics);
    sim_->SetState(env, {grasp.q, std::vector<double>(joints_, 0.0), grasp.X_WO});
    sim_->SetHeld(env, false);
    std::copy(grasp.target.begin(), grasp.target.end(), targets.begin() + env * joints_);
    active[env] = 1;
  }
  SimState before;
  for (int step = 0; step < options_.hold_steps; ++step) {
    before = sim_->state();
    sim_->Step(targets, active);
    for (std::size_t env = 0; env < n; ++env)
      active[env] = active[env] && rule_.Near(sim_->state(), env);
  }
  for (std::size_t env = 0; env < n; ++env)
    active[env] = active[env] && rule_.AtRest(before, sim_->state(), env) &&
                  rule_.Gripped(sim_->state(), env);
  active.resize(n);
  return active;
}

}  // namespace dexremoe::internal
