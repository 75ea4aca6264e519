// Convex hulls through qhull (Barber, Dobkin, Huhdanpaa 1996).
#pragma once

#include <optional>
#include <vector>

#include "geometry/mesh.h"

namespace dexremoe {

struct HullOptions {
  // At most so many vertices (0: no limit, otherwise at least 4), chosen greedily: the vertex
  // farthest outside the hull of those chosen so far comes next.
  int max_vertices = 0;
  // Input flatter than kFlatRatio of its size gets this thickness, m; 0 gives no hull instead.
  double thicken = 0;
};
inline constexpr double kFlatRatio = 1e-6;

// The hull as a closed mesh wound counter-clockwise from outside; its vertices are input points
// (except where thickened). Empty when the points are fewer than four or lie in a plane.
std::optional<TriMesh> ConvexHull(const std::vector<Eigen::Vector3d>& points,
                                  const HullOptions& options = {});

// Corners and volume of the hull without its faces: much quicker, for searches that try many hulls.
struct HullSummary {
  std::vector<Eigen::Vector3d> vertices;
  double volume = 0;  // m^3
};
std::optional<HullSummary> SummariseHull(const std::vector<Eigen::Vector3d>& points);

// Largest distance that `point` lies outside a face plane of `hull`; negative inside.
double DistanceOutside(const TriMesh& hull, const Eigen::Vector3d& point);

// Volume that two convex meshes share, by a fixed set of sample points: right to a few percent of
// the overlap of their bounding boxes.
double SharedVolume(const TriMesh& a, const TriMesh& b);

}  // namespace dexremoe
