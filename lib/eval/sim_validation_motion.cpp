// Free fall, tumbling, joint steps and slip: scenes without a grasp.
#include <algorithm>
#include <cmath>

#include "eval/sim_scenes.h"
#include "eval/sim_validation.h"

namespace dexremoe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const Vector3d kFarAway(0, 0, 3);
constexpr double kDegree = M_PI / 180;

EnvState StateAt(int joints, const Vector3d& p) {
  EnvState state;
  state.q.assign(joints, 0.0);
  state.qd = state.q;
  state.X_WO.p = p;
  return state;
}

int StepsIn(const SimOptions& sim, double seconds) {
  return static_cast<int>(std::lround(seconds * sim.control_rate));
}

}  // namespace

FallError FreeFallError(const SimOptions& sim_options, ThreadPool& pool) {
  const auto sim = MakeBatchSim(sim_options, BoardHand(),
                                {BoxObject("cube", Vector3d::Constant(0.055))}, 1, pool);
  EnvPhysics physics;
  physics.gravity = {0, 0, sim_options.gravity};
  sim->SetObject(0, 0, physics);
  sim->SetState(0, StateAt(0, kFarAway));
  const int steps = StepsIn(sim_options, 1);
  for (int i = 0; i < steps; ++i) sim->Step({});
  const double t = steps / sim_options.control_rate;
  const EnvState after = sim->GetState(0);
  return {(after.X_WO.p - kFarAway - t * t / 2 * physics.gravity).norm(),
          (after.v - t * physics.gravity).norm()};
}

TumbleError TumbleErrors(const SimOptions& sim_options, ThreadPool& pool) {
  const SimObject block = BoxObject("block", {0.04, 0.06, 0.09});
  const auto sim = MakeBatchSim(sim_options, BoardHand(), {block}, 1, pool);
  EnvPhysics physics;
  physics.gravity.setZero();
  sim->SetObject(0, 0, physics);
  EnvState state = StateAt(0, kFarAway);
  state.w = {1, 5, 0.5};
  sim->SetState(0, state);
  const auto momentum = [&](const EnvState& s) -> Vector3d {
    const Matrix3d R = s.X_WO.q.normalized().toRotationMatrix();
    return R * block.unit_inertia * R.transpose() * s.w;
  };
  const Vector3d before = momentum(state);
  const double energy = state.w.dot(before);
  for (int i = 0; i < StepsIn(sim_options, 1); ++i) sim->Step({});
  const EnvState last = sim->GetState(0);
  const Vector3d after = momentum(last);
  return {(after - before).norm() / before.norm(), std::abs(last.w.dot(after) / energy - 1)};
}

std::vector<double> JointStepResponse(const SimOptions& sim_options, const HandModel& hand,
                                      double amplitude, int steps, ThreadPool& pool) {
  const int joints = hand.num_joints();
  const auto sim =
      MakeBatchSim(sim_options, hand, {BoxObject("cube", Vector3d::Constant(0.055))}, 1, pool);
  EnvPhysics physics;
  physics.gravity = {0, 0, sim_options.gravity};
  sim->SetObject(0, 0, physics);
  EnvState state = StateAt(joints, kFarAway);
  std::vector<double> targets(joints), response;
  for (int j = 0; j < joints; ++j) {
    const Joint& joint = hand.joints[j];
    state.q[j] = (joint.lower + joint.upper) / 2;
    targets[j] =
        std::clamp(state.q[j] + (j % 2 ? -amplitude : amplitude), joint.lower, joint.upper);
  }
  sim->SetState(0, state);
  sim->SetHeld(0, true);
  for (int i = 0; i < steps; ++i) {
    sim->Step(targets);
    const std::vector<double>& q = sim->state().joint_position;
    response.insert(response.end(), q.begin(), q.begin() + joints);
  }
  return response;
}

double SlipAngle(const SimOptions& sim_options, double friction, double direction,
                 ThreadPool& pool) {
  constexpr int kHalf = 80;  // environment kHalf has the slope atan(friction)
  constexpr double kStep = 0.1 * kDegree, kCreep = 5e-3, kThickness = 0.02;
  const int envs = 2 * kHalf + 1;
  const auto sim = MakeBatchSim(sim_options, BoardHand(),
                                {BoxObject("block", {0.06, 0.06, kThickness})}, envs, pool);
  const auto angle = [&](int env) { return std::atan(friction) + (env - kHalf) * kStep; };
  for (int env = 0; env < envs; ++env) {
    EnvPhysics physics;
    physics.friction = friction;
    physics.gravity = sim_options.gravity * Vector3d(std::sin(angle(env)) * std::cos(direction),
                                                     std::sin(angle(env)) * std::sin(direction),
                                                     -std::cos(angle(env)));
    sim->SetObject(env, 0, physics);
    sim->SetState(env, StateAt(0, {0, 0, kThickness / 2 + 1e-4}));
  }
  const int steps = StepsIn(sim_options, 1.0 / 3);
  for (int i = 0; i < steps; ++i) sim->Step({});
  const std::vector<double> start = sim->state().object_position;
  for (int i = 0; i < steps; ++i) sim->Step({});
  int env = 0;
  for (; env < envs; ++env) {
    const Vector3d moved =
        Vector3d(&sim->state().object_position[3 * env]) - Vector3d(&start[3 * env]);
    if (moved.norm() * sim_options.control_rate / steps > kCreep) break;
  }
  return angle(env) - kStep;
}

}  // namespace dexremoe
