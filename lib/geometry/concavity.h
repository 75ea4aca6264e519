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
  struct Fit {
    double distance = 0;  // between hull and surface, m
    int deepest = -1;     // the voxel whose surface lies deepest below the hull; -1: none does
  };

  // A distance of `unit` (m) is to weigh as much as `cost` (m^3) of excess volume, other distances
  // by their cubes. `solid` must outlive it.
  Concavity(const VoxelSolid& solid, double unit, double cost);

  // The distance is the larger of two: how far the hull gets outside the solid, and how deep the
  // solid's surface within these voxels lies below the hull.
  Fit FitOf(const TriMesh& hull, const std::vector<int>& voxels) const;
  // What a distance costs, m^3.
  double CostOf(double distance) const;

 private:
  double StickOut(const TriMesh& hull) const;
  Fit Depth(const TriMesh& hull, const std::vector<int>& voxels) const;

  const VoxelSolid& solid_;
  double unit_, cost_;
  DistanceGrid outside_;  // distance to the solid at the middle of every voxel; 0 inside
};

}  // namespace dexremoe
