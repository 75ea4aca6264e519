#include <algorithm>
#include <cmath>

#include "geometry/decompose.h"
#include "geometry/hull.h"
#include "geometry/triangle_bvh.h"

namespace dexremoe {
namespace {

constexpr int kSamples = 6000;  // on either surface
// Slits between parts, deep in the solid and thinner than this share of the diagonal, are not
// surface: parts that were cut apart and limited in vertices do not meet exactly.
constexpr double kJoint = 0.01;

// A part with its face planes, for quick inside tests.
class PartTester {
 public:
  explicit PartTester(const TriMesh& part) : bounds_(BoundsOf(part)) {
    for (const auto& [a, b, c] : part.triangles) {
      const Eigen::Vector3d& origin = part.vertices[a];
      const Eigen::Vector3d normal =
          (part.vertices[b] - origin).cross(part.vertices[c] - origin).stableNormalized();
      planes_.push_back({normal, normal.dot(origin)});
    }
  }
  // Deeper than `margin` below every face.
  bool Contains(const Eigen::Vector3d& p, double margin) const {
    if ((p.array() < bounds_.min.array() + margin).any() ||
        (p.array() > bounds_.max.array() - margin).any())
      return false;
    return std::all_of(planes_.begin(), planes_.end(), [&](const Plane& plane) {
      return plane.normal.dot(p) - plane.offset < -margin;
    });
  }

 private:
  struct Plane {
    Eigen::Vector3d normal;
    double offset;
  };
  Box3 bounds_;
  std::vector<Plane> planes_;
};

// The surface of the union of convex parts: what of each part's surface is inside no other part.
// Parts that were cut apart meet face to face; such a joint inside the solid, with another part
// within `joint`, is not surface.
class UnionSurface {
 public:
  UnionSurface(const ConvexParts& parts, const TriangleBvh& solid, double margin, double joint)
      : solid_(solid), margin_(margin), joint_(joint) {
    double area = 0;
    std::vector<double> areas;
    for (const TriMesh& part : parts) {
      trees_.emplace_back(part);
      testers_.emplace_back(part);
      areas.push_back(AreaOf(part));
      area += areas.back();
    }
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const int count = static_cast<int>(std::ceil(kSamples * areas[i] / area));
      for (const Eigen::Vector3d& p : SpreadOverSurface(parts[i], count))
        if (!Buried(p, i)) {
          samples_.push_back(p);
          part_of_sample_.push_back(i);
        }
    }
  }
  const std::vector<Eigen::Vector3d>& samples() const { return samples_; }
  std::size_t PartOf(std::size_t sample) const { return part_of_sample_[sample]; }

  // Exact where the nearest point of some part is on the surface of the union (always for points
  // outside), else to the nearest sample.
  double Distance(const Eigen::Vector3d& p) const {
    double distance = INFINITY;
    for (std::size_t i = 0; i < trees_.size(); ++i) {
      const SurfacePoint nearest = trees_[i].Closest(p);
      if (nearest.distance < distance && !Buried(nearest.point, i)) distance = nearest.distance;
    }
    if (distance < margin_) return distance;
    for (const Eigen::Vector3d& sample : samples_)
      distance = std::min(distance, (sample - p).norm());
    return distance;
  }

 private:
  static double AreaOf(const TriMesh& mesh) {
    double area = 0;
    for (const auto& [a, b, c] : mesh.triangles)
      area +=
          (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).norm();
    return area;
  }
  bool Buried(const Eigen::Vector3d& p, std::size_t own) const {
    for (std::size_t i = 0; i < testers_.size(); ++i)
      if (i != own && testers_[i].Contains(p, margin_)) return true;
    for (std::size_t i = 0; i < testers_.size(); ++i)
      if (i != own && testers_[i].Contains(p, -joint_))
        return solid_.WindingNumber(p) > 0.5 && solid_.Closest(p).distance > joint_;
    return false;
  }
  const TriangleBvh& solid_;
  double margin_, joint_;
  std::vector<TriangleBvh> trees_;
  std::vector<PartTester> testers_;
  std::vector<Eigen::Vector3d> samples_;
  std::vector<std::size_t> part_of_sample_;
};

}  // namespace

DecompositionQuality QualityOf(const TriMesh& mesh, const ConvexParts& parts) {
  DecompositionQuality quality;
  for (const TriMesh& part : parts) quality.volume_ratio += MassPropertiesOf(part).volume;
  quality.volume_ratio /= MassPropertiesOf(mesh).volume;

  const double diagonal = BoundsOf(mesh).Size().norm();
  const TriangleBvh surface(mesh);
  const UnionSurface hulls(parts, surface, 1e-6 * diagonal, kJoint * diagonal);
  double distance = 0;
  quality.stick_out.assign(parts.size(), 0);
  for (std::size_t i = 0; i < hulls.samples().size(); ++i) {
    const Eigen::Vector3d& p = hulls.samples()[i];
    const double off = surface.Closest(p).distance;
    distance = std::max(distance, off);
    double& stick_out = quality.stick_out[hulls.PartOf(i)];
    if (off > stick_out && surface.WindingNumber(p) < 0.5) stick_out = off;
  }
  for (const Eigen::Vector3d& p : SpreadOverSurface(mesh, kSamples))
    distance = std::max(distance, hulls.Distance(p));
  quality.hausdorff_ratio = distance / diagonal;
  return quality;
}

}  // namespace dexremoe
