#include "task/observation.h"

#include <algorithm>

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

void WritePhys(const EnvPhysics& physics, const ObjectMotion& motion,
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
}

}  // namespace dexremoe::internal
