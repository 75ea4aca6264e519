// A closed mesh cut into voxels, each with its exact share of volume and surface.
#pragma once

#include <array>
#include <vector>

#include "geometry/mesh.h"

namespace dexremoe {

struct Voxel {
  std::array<int, 3> cell;  // indices along x, y, z
  double volume = 0;        // of the solid within the voxel, m^3
  // Corners of the surface pieces within the voxel and corners of the voxel within the solid:
  // points [first, first + count); the extreme ones in 26 directions come first. An inner voxel has
  // none.
  int first = 0, count = 0, extreme = 0;
  Eigen::Vector3d on_surface = Eigen::Vector3d::Zero();  // some point of those pieces; m
  bool inner() const { return count == 0; }
};

// Only voxels that the solid touches, sorted by z, y, x.
struct VoxelSolid {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // low corner of cell (0, 0, 0); m
  double spacing = 0;                                // m
  std::array<int, 3> dims = {0, 0, 0};
  std::vector<Voxel> voxels;
  std::vector<Eigen::Vector3d> points;  // m
  double volume = 0;                    // m^3

  Eigen::Vector3d Corner(const std::array<int, 3>& cell) const {
    return origin + spacing * Eigen::Vector3d(cell[0], cell[1], cell[2]);
  }
};

// Side of the voxels when `resolution` of them fill a box; m.
double VoxelSize(const Box3& bounds, int resolution);

// About `resolution` voxels in the bounding box. The mesh has no open edges and is wound outward;
// shells may overlap. The volume of each voxel follows from its surface pieces by integrating along
// z columns, which is the inside fill as well.
VoxelSolid Voxelise(const TriMesh& mesh, int resolution);

}  // namespace dexremoe
