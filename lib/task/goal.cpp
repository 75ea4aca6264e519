#include "task/goal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace dexremoe {
namespace {

// The angle below which a Haar-uniform rotation lies with probability mass / pi: the inverse of
// angle - sin(angle), by bisection.
double InverseHaarMass(double mass) {
  double low = 0, high = std::numbers::pi;
  for (int k = 0; k < 60; ++k) {
    const double middle = (low + high) / 2;
    (middle - std::sin(middle) < mass ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace

Eigen::Quaterniond DrawGoal(Rng& rng, const Eigen::Quaterniond& q_WO, double min_angle,
                            double max_angle) {
  const std::array<double, 4> u = rng.UnitQuaternion();
  const Eigen::Quaterniond haar(u[0], u[1], u[2], u[3]);
  if (max_angle >= std::numbers::pi) return haar;
  // The axis of a Haar-uniform rotation is uniform and independent of its angle.
  const double low = std::min(min_angle, max_angle);
  const double mass_low = low - std::sin(low), mass_high = max_angle - std::sin(max_angle);
  const double angle = InverseHaarMass(rng.Uniform(mass_low, mass_high));
  const Eigen::Vector3d axis = haar.vec().stableNormalized();
  return (Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)) * q_WO).normalized();
}

}  // namespace dexremoe
