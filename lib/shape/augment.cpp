#include "shape/augment.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace dexremoe {

void AugmentOptions::Register(Options& options) {
  options.Add("shape.stretch", &stretch, "training clouds: each axis times U[1 - s, 1 + s]")
      .Range(0, 0.9);
  options.Add("shape.thin", &thin, "training clouds: largest part of the points left out")
      .Range(0, 0.95);
  options.Add("shape.jitter", &jitter, "training clouds: noise, unit-sphere units").Range(0, 1);
  options.Add("shape.jitter_clip", &jitter_clip, "bound of the noise, unit-sphere units")
      .Range(0, 1);
}

std::vector<Eigen::Vector3f> AugmentCloud(std::span<const Eigen::Vector3f> points,
                                          const AugmentOptions& options, Rng& rng) {
  const auto [w, x, y, z] = rng.UnitQuaternion();
  Eigen::Vector3d stretch;
  for (double& s : stretch) s = rng.Uniform(1 - options.stretch, 1 + options.stretch);
  const Eigen::Matrix3f A =
      (Eigen::Quaterniond(w, x, y, z).toRotationMatrix() * stretch.asDiagonal()).cast<float>();
  const double left_out = rng.Uniform(0, options.thin);
  std::vector<Eigen::Vector3f> variant;
  variant.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool needed = variant.size() + (points.size() - i) <= 4;
    if (rng.Uniform() < left_out && !needed) continue;
    Eigen::Vector3f p = A * points[i];
    for (float& c : p)
      c += static_cast<float>(
          std::clamp(options.jitter * rng.Normal(), -options.jitter_clip, options.jitter_clip));
    variant.push_back(p);
  }
  return variant;
}

}  // namespace dexremoe
