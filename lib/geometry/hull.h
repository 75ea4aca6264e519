// Convex hulls through qhull (Barber, Dobkin, Huhdanpaa 1996).
#pragma once

#include <array>
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

// Indices of up to four points that span the largest simplex a greedy search finds; fewer than four
// when the points lie in a plane (three), on a line (two) or at one place (one). At least one
// point.
std::vector<int> SpanningSimplex(const std::vector<Eigen::Vector3d>& points);

// Triangles over `points` with only the points that they use.
TriMesh Compacted(const std::vector<Eigen::Vector3d>& points,
                  const std::vector<std::array<int, 3>>& triangles);

// Volume of the convex hull, m^3, by GrowingHull; 0 when flat.
double HullVolume(const std::vector<Eigen::Vector3d>& points);

// Largest distance that `point` lies outside a face plane of `hull`; negative inside.
double DistanceOutside(const TriMesh& hull, const Eigen::Vector3d& point);

// Volume that two convex meshes share, by a fixed set of sample points: right to a few percent of
// the overlap of their bounding boxes.
double SharedVolume(const TriMesh& a, const TriMesh& b);

}  // namespace dexremoe
