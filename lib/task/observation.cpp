#include "task/observation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "task/rotation.h"

namespace dexremoe::internal {
namespace {

constexpr int kPlaces = 3;

void WritePlace(const TaskOptions& options, const HandModel& hand, int place, const double* q,
                const double* command, float* obs) {
  const int joints = hand.num_joints();
  // NOTE(paper): "actions" are the executed, averaged actions by default. With relative targets the
  // target itself is the other reading (and says how hard the hand squeezes): observe = "target".
  const bool targets = options.observe == "target";
  for (int j = 0; j < joints; ++j) {
    const Joint& joint = hand.joints[j];
    const double shown = targets ? ScaledToLimits(joint, command[j]) : command[j];
    obs[place * joints + j] = static_cast<float>(ScaledToLimits(joint, q[j]));
    obs[(kPlaces + place) * joints + j] = static_cast<float>(shown);
  }
}

bool Shows(const TaskOptions& options, const char* name) {
  const auto& names = options.extra_inputs;
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

void StartHistory(const TaskOptions& options, const HandModel& hand, const double* q,
                  const double* command, float* obs) {
  for (int place = 0; place < kPlaces; ++place) WritePlace(options, hand, place, q, command, obs);
}

void PushHistory(const TaskOptions& options, const HandModel& hand, const double* q,
                 const double* command, float* obs) {
  const int joints = hand.num_joints();
  for (float* half : {obs, obs + kPlaces * joints})
    std::copy(half + joints, half + kPlaces * joints, half);
  WritePlace(options, hand, kPlaces - 1, q, command, obs);
}

Eigen::Quaterniond ShownGoal(const TaskOptions& options, const Eigen::Quaterniond& q_WO,
                             const Eigen::Quaterniond& q_WG) {
  const Eigen::Vector3d turn = RotationVector(q_WG * q_WO.conjugate());
  const double angle = turn.norm();
  if (angle <= options.goal_shown) return q_WG;
  return Eigen::Quaterniond(Eigen::AngleAxisd(options.goal_shown, turn / angle)) * q_WO;
}

float* WritePhys(const EnvPhysics& physics, const ObjectMotion& motion,
                 const Eigen::Quaterniond& q_WG, float* phys) {
  const auto put = [&](double value) { *phys++ = static_cast<float>(value); };
  const auto put_vector = [&](const Eigen::Vector3d& v) { put(v.x()), put(v.y()), put(v.z()); };
  const auto put_rotation = [&](const Eigen::Quaterniond& rotation) {
    const Eigen::Quaterniond q = Canonical(rotation);
    put(q.w()), put(q.x()), put(q.y()), put(q.z());
  };
  put(physics.mass);
  put_vector(physics.com);
  put(physics.friction);
  put(physics.scale);
  put_vector(motion.X_WO.p);
  put_rotation(motion.X_WO.q);
  put_vector(motion.v);
  put_vector(motion.w);
  put_rotation(motion.X_WO.q * q_WG.conjugate());
  return phys;
}

void WriteExtras(const TaskOptions& options, const HandModel& hand, const HandMotion& hand_motion,
                 const Pose& X_WO, const Eigen::Quaterniond& q_WG, float* extras) {
  const auto put = [&](double value) { *extras++ = static_cast<float>(value); };
  if (Shows(options, "goal_vector"))
    for (const double x : RotationVector(q_WG * X_WO.q.conjugate())) put(x);
  if (Shows(options, "joint_speed"))
    for (int j = 0; j < hand.num_joints(); ++j) put(hand_motion.qd[j]);
  if (Shows(options, "tip_position")) {
    const std::vector<Pose> X_WL = ForwardKinematics(hand, hand_motion.q);
    for (std::size_t f = 0; f < hand.chains.size(); ++f) {
      const Pose X_WF = X_WL[hand.joints[hand.chains[f].back()].child] * hand.tip_frames[f];
      for (const double x : Eigen::Vector3d(X_WF.p - X_WO.p)) put(x);
    }
  }
  if (Shows(options, "tip_contact"))
    for (std::size_t f = 0; f < hand.chains.size(); ++f) put(hand_motion.tip_contact[f]);
  if (Shows(options, "wait_clock")) {
    const double phase = 2 * std::numbers::pi * hand_motion.waited / kWaitPeriod;
    put(std::sin(phase)), put(std::cos(phase));
  }
}

}  // namespace dexremoe::internal

namespace dexremoe {

int PhysSize(const TaskOptions& options, const HandModel& hand) {
  const int fingers = static_cast<int>(hand.chains.size());
  int size = kPhysSize;
  if (internal::Shows(options, "goal_vector")) size += 3;
  if (internal::Shows(options, "joint_speed")) size += hand.num_joints();
  if (internal::Shows(options, "tip_position")) size += 3 * fingers;
  if (internal::Shows(options, "tip_contact")) size += fingers;
  if (internal::Shows(options, "wait_clock")) size += 2;
  return size;
}

std::vector<int> ObservableColumns(const TaskOptions& options, const HandModel& hand) {
  // WritePhys: mass, centre of mass, friction, scale; position 6..8, orientation 9..12; velocity,
  // spin; relative orientation 19..22.
  std::vector<int> columns = {6, 7, 8, 9, 10, 11, 12, 19, 20, 21, 22};
  int next = kPhysSize;
  const auto add = [&](const char* name, int count, bool seen) {
    if (!internal::Shows(options, name)) return;
    for (int i = 0; seen && i < count; ++i) columns.push_back(next + i);
    next += count;
  };
  const int fingers = static_cast<int>(hand.chains.size());
  add("goal_vector", 3, true);
  add("joint_speed", hand.num_joints(), true);
  add("tip_position", 3 * fingers, true);
  add("tip_contact", fingers, false);
  add("wait_clock", 2, true);
  return columns;
}

}  // namespace dexremoe
