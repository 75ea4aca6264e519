// How far apart a convex part and the surface of the solid that it stands for lie.
#pragma once

#include <vector>

#include "geometry/distance_field.h"
#include "geometry/mesh.h"
#include "geometry/voxel_solid.h"

namespace dexremoe {

// Measures hulls of pieces of one solid, right to about half a voxel.
class Concavity {
 public:
  // A distance of `unit` (m) is to weigh as much as `cost` (m^3) of excess volume, other distances
  // by their cubes. `solid` must outlive it.
  Concavity(const VoxelSolid& solid, double unit, double cost);

  // The larger of two distances, m: how far the hull gets outside the solid, and how deep the
  // solid's surface within these voxels lies below the hull.
  double DistanceOf(const TriMesh& hull, const std::vector<int>& voxels) const;
  // What that distance costs, m^3.
  double CostOf(const TriMesh& hull, const std::vector<int>& voxels) const;

 private:
  double StickOut(const TriMesh& hull) const;
  double Depth(const TriMesh& hull, const std::vector<int>& voxels) const;

  const VoxelSolid& solid_;
  double unit_, cost_;
  DistanceGrid outside_;  // distance to the solid at the middle of every voxel; 0 inside
};

}  // namespace dexremoe
