// Rigid transforms. X_AB maps coordinates in frame B to coordinates in frame A.
#pragma once

#include <Eigen/Geometry>

namespace dexremoe {

struct Pose {
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();  // R_AB
  Eigen::Vector3d p = Eigen::Vector3d::Zero();            // p_AB, m

  // X_AC = X_AB * X_BC.
  Pose operator*(const Pose& X_BC) const { return {q * X_BC.q, q * X_BC.p + p}; }
  // p_A = X_AB * p_B.
  Eigen::Vector3d operator*(const Eigen::Vector3d& p_B) const { return q * p_B + p; }
  Pose Inverse() const { return {q.conjugate(), q.conjugate() * -p}; }
};

// URDF convention: fixed-axis roll, pitch, yaw, i.e. R = Rz(yaw) Ry(pitch) Rx(roll); rad.
inline Eigen::Quaterniond QuaternionFromRpy(double roll, double pitch, double yaw) {
  return Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX());
}

}  // namespace dexremoe
