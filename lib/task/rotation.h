// Small facts about rotations. Quaternions are unit; q and -q are the same rotation.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace dexremoe {

// The representative with w >= 0.
inline Eigen::Quaterniond Canonical(const Eigen::Quaterniond& q) {
  return q.w() < 0 ? Eigen::Quaterniond(-q.coeffs()) : q;
}

// Angle of the rotation that leads from b to a, in [0, pi], rad. Exact near 0 and near pi.
inline double RotationDistance(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  const Eigen::Quaterniond d = a * b.conjugate();
  return 2 * std::atan2(d.vec().norm(), std::abs(d.w()));
}

// Axis times angle, angle in [0, pi], rad.
inline Eigen::Vector3d RotationVector(const Eigen::Quaterniond& rotation) {
  const Eigen::Quaterniond q = Canonical(rotation);
  const double sine = q.vec().norm();
  if (sine < 1e-12) return 2 * q.vec();
  return 2 * std::atan2(sine, q.w()) / sine * q.vec();
}

}  // namespace dexremoe
