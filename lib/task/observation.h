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
// e_phys, see kPhysSize.
void WritePhys(const EnvPhysics& physics, const ObjectMotion& motion,
               const Eigen::Quaterniond& q_WG, float* phys);

}  // namespace dexremoe::internal
