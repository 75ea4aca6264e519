// Rows of o_t and e_phys. Internal to lib/task.
#pragma once

#include "task/reorient.h"

namespace dexremoe::internal {

// q with the joint's limits at -1 and 1.
inline double ScaledToLimits(const Joint& joint, double q) {
  return (2 * q - joint.lower - joint.upper) / (joint.upper - joint.lower);
}

// o_t is its own history: J joint angles for each of t-2, t-1, t, then J commands for each of t-3,
// t-2, t-1. `command` holds the executed actions, or targets when options.observe says so.
// Fills all three places.
void StartHistory(const TaskOptions& options, const HandModel& hand, const double* q,
                  const double* command, float* obs);
// Moves every place one step back and writes the last.
void PushHistory(const TaskOptions& options, const HandModel& hand, const double* q,
                 const double* command, float* obs);

struct ObjectMotion {
  Pose X_WO;
  Eigen::Vector3d v = Eigen::Vector3d::Zero();  // m/s, W
  Eigen::Vector3d w = Eigen::Vector3d::Zero();  // rad/s, W
};
// The goal as the policy sees it: q_WG, or the orientation options.goal_shown away on the way
// there.
Eigen::Quaterniond ShownGoal(const TaskOptions& options, const Eigen::Quaterniond& q_WO,
                             const Eigen::Quaterniond& q_WG);

// The first kPhysSize numbers of e_phys; returns one past the last.
float* WritePhys(const EnvPhysics& physics, const ObjectMotion& motion,
                 const Eigen::Quaterniond& q_WG, float* phys);

// What the policy sees of the present state: with randomisation a noisy pose and noisy joints.
struct Sight {
  ObjectMotion motion;
  const double* q;             // [J] rad
  std::vector<double> joints;  // what q points into when they are noisy
};

struct HandMotion {
  const double* q;                  // [J] rad
  const double* qd;                 // [J] rad/s
  const std::uint8_t* tip_contact;  // [F]
  int waited;                       // control steps since the last success or the start
};
// The rest of e_phys, as options.extra_inputs asks (see PhysSize).
void WriteExtras(const TaskOptions& options, const HandModel& hand, const HandMotion& hand_motion,
                 const Pose& X_WO, const Eigen::Quaterniond& q_WG, float* extras);

}  // namespace dexremoe::internal
