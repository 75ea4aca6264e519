// Signed distance on a regular grid, for closed meshes and for open, overlapping soups alike.
#pragma once

#include <array>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/triangle_bvh.h"

namespace dexremoe {

// Values at the nodes of a regular grid, x fastest.
struct DistanceGrid {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // node (0, 0, 0); m
  double spacing = 0;                                // m
  std::array<int, 3> dims = {0, 0, 0};               // nodes along x, y, z
  std::vector<double> values;                        // m; negative inside

  std::size_t Index(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * dims[1] + y) * dims[0] + x;
  }
  Eigen::Vector3d Position(int x, int y, int z) const {
    return origin + spacing * Eigen::Vector3d(x, y, z);
  }
  // Trilinear; positions outside the grid take the nearest position on its border.
  double Sample(const Eigen::Vector3d& p) const;
};

// A grid around `bounds` with `resolution` cells along the longest side and `margin` more cells
// on every side; the values are not filled in.
DistanceGrid GridAround(const Box3& bounds, int resolution, int margin);

// Fills a grid with the exact distance to the nearest triangle, negative where the generalised
// winding number exceeds one half (Jacobson, Kavan, Sorkine-Hornung 2013), so that holes and
// overlapping shells do no harm.
void FillSignedDistance(const TriangleBvh& surface, DistanceGrid& grid);

}  // namespace dexremoe
