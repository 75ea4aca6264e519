// The surface of unions of convex parts and the distance to it.
#include "sim/lanes/object_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "geometry/hull.h"
#include "scenes.h"

namespace dexremoe {
namespace {

using Eigen::Vector3d;

// Overlapping hulls of random points, not boxes.
ConvexParts RandomHulls(Rng& rng) {
  ConvexParts parts;
  for (int part = 0; part < 5; ++part) {
    const Vector3d center(rng.Uniform(-0.03, 0.03), rng.Uniform(-0.02, 0.02),
                          rng.Uniform(-0.02, 0.02));
    std::vector<Vector3d> points;
    for (int i = 0; i < 40; ++i)
      points.push_back(center + 0.01 * Vector3d(rng.Normal(), rng.Normal(), rng.Normal()));
    parts.push_back(*ConvexHull(points, {}));
  }
  return parts;
}

// The depth of p in the part that holds it best; negative in none. m.
double BestDepth(const ConvexParts& parts, const Vector3d& p) {
  double depth = -INFINITY;
  for (const TriMesh& part : parts) depth = std::max(depth, -DistanceOutside(part, p));
  return depth;
}

Vector3d RandomPoint(Rng& rng) {
  return {rng.Uniform(-0.06, 0.06), rng.Uniform(-0.05, 0.05), rng.Uniform(-0.05, 0.05)};
}

TEST(UnionDistance, IsExactOutsideRandomHulls) {
  Rng rng(7, Stream::kTest);
  const ConvexParts parts = RandomHulls(rng);
  UnionDistance distance(parts);
  int outside = 0;
  while (outside < 1000) {
    const Vector3d p = RandomPoint(rng);
    if (BestDepth(parts, p) >= 0) continue;
    double nearest = INFINITY;
    for (const TriMesh& part : parts)
      for (const auto& [a, b, c] : part.triangles) {
        const Vector3d q =
            ClosestPointOnTriangle(p, part.vertices[a], part.vertices[b], part.vertices[c]);
        nearest = std::min(nearest, (p - q).norm());
      }
    ++outside;
    // Points in crevices narrower than kSeam count as inside.
    if (nearest > kSeam) {
      EXPECT_NEAR(distance.Signed(p), nearest, 1e-12);
    } else {
      EXPECT_LE(distance.Signed(p), nearest + 1e-12);
    }
  }
}

TEST(UnionDistance, IsTheDepthBelowTheUnionsSurfaceInside) {
  Rng rng(8, Stream::kTest);
  const ConvexParts parts = RandomHulls(rng);
  std::vector<Vector3d> surface;  // samples, about half a millimetre apart
  for (const TriMesh& part : parts)
    for (const Vector3d& p : SpreadOverSurface(part, 8000))
      if (BestDepth(parts, p) < 1e-9) surface.push_back(p);
  UnionDistance distance(parts);
  int inside = 0, close = 0;
  while (inside < 300) {
    const Vector3d p = RandomPoint(rng);
    if (BestDepth(parts, p) < 0) continue;
    ++inside;
    double nearest = INFINITY;
    for (const Vector3d& q : surface) nearest = std::min(nearest, (p - q).norm());
    const double depth = -distance.Signed(p);
    EXPECT_GT(depth, nearest - kSeam - 1e-3);  // nowhere too shallow
    close += depth < nearest + 1e-4;           // too deep below closed crevices only
  }
  EXPECT_GT(close, 270);
}

double AreaOf(const TriMesh& mesh) {
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    area +=
        (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).norm() / 2;
  return area;
}

TEST(UnionSurface, HasTheAreaOfTheUnion) {
  const TriMesh a = scenes::BoxMesh({0.04, 0.02, 0.02}), b = scenes::BoxMesh({0.02, 0.05, 0.01});
  EXPECT_NEAR(AreaOf(UnionSurface({a})), AreaOf(a), 1e-12);
  // Abutting along x: two faces go.
  const TriMesh beside = scenes::BoxMesh({0.04, 0.02, 0.02}, {0.04, 0, 0});
  EXPECT_NEAR(AreaOf(UnionSurface({a, beside})), 2 * AreaOf(a) - 2 * 0.02 * 0.02, 1e-9);
  // A bar through a block: the block loses two windows, the bar keeps its two ends.
  const double block = AreaOf(a) - 2 * 0.02 * 0.01;
  const double ends = 2 * (0.02 * 0.01 + 2 * (0.02 + 0.01) * 0.015);
  EXPECT_NEAR(AreaOf(UnionSurface({a, b})), block + ends, 1e-9);
  // Nothing is seen of a box within another; flush faces stay.
  EXPECT_NEAR(AreaOf(UnionSurface({a, scenes::BoxMesh({0.03, 0.01, 0.01})})), AreaOf(a), 1e-9);
  EXPECT_NEAR(AreaOf(UnionSurface({a, a})), 2 * AreaOf(a), 1e-9);
}

}  // namespace
}  // namespace dexremoe
