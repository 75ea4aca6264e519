#include "geometry/concavity.h"

#include <algorithm>
#include <cmath>

namespace dexremoe {
namespace {

constexpr double kSampleVoxels = 1.5;  // distance of the samples on a hull

// Nearest surface point of every cell by two sweeps over the grid, each passing points on from the
// 13 neighbours swept before (after Danielsson 1980).
class NearestSurface {
 public:
  NearestSurface(const VoxelSolid& solid, DistanceGrid& grid)
      : solid_(solid), grid_(grid), voxel_of_cell_(grid.values.size(), -1) {}

  void Run() {
    for (std::size_t i = 0; i < solid_.voxels.size(); ++i) {
      const Voxel& voxel = solid_.voxels[i];
      const std::size_t cell = grid_.Index(voxel.cell[0], voxel.cell[1], voxel.cell[2]);
      const bool full = voxel.volume > 0.5 * std::pow(solid_.spacing, 3);
      if (full) grid_.values[cell] = 0;
      if (!voxel.inner()) Offer(voxel.cell, cell, static_cast<int>(i));
    }
    const auto [nx, ny, nz] = grid_.dims;
    for (int z = 0; z < nz; ++z)
      for (int y = 0; y < ny; ++y)
        for (int x = 0; x < nx; ++x) Gather({x, y, z}, -1);
    for (int z = nz - 1; z >= 0; --z)
      for (int y = ny - 1; y >= 0; --y)
        for (int x = nx - 1; x >= 0; --x) Gather({x, y, z}, 1);
  }

 private:
  void Offer(const std::array<int, 3>& at, std::size_t cell, int voxel) {
    const double distance =
        (grid_.Position(at[0], at[1], at[2]) - solid_.voxels[voxel].on_surface).norm();
    if (voxel_of_cell_[cell] >= 0 && distance >= grid_.values[cell]) return;
    if (grid_.values[cell] > 0) grid_.values[cell] = distance;
    voxel_of_cell_[cell] = voxel;
  }
  // From the neighbours on one side in sweeping order.
  void Gather(const std::array<int, 3>& at, int side) {
    const std::size_t cell = grid_.Index(at[0], at[1], at[2]);
    if (grid_.values[cell] == 0) return;
    for (int code = 14; code < 27; ++code) {
      const std::array<int, 3> other = {at[0] + side * (code % 3 - 1),
                                        at[1] + side * (code / 3 % 3 - 1),
                                        at[2] + side * (code / 9 - 1)};
      bool within = true;
      for (int k = 0; k < 3; ++k) within = within && other[k] >= 0 && other[k] < grid_.dims[k];
      if (!within) continue;
      const int voxel = voxel_of_cell_[grid_.Index(other[0], other[1], other[2])];
      if (voxel >= 0) Offer(at, cell, voxel);
    }
  }

  const VoxelSolid& solid_;
  DistanceGrid& grid_;
  std::vector<int> voxel_of_cell_;  // holds the nearest surface point; -1: none yet
};

}  // namespace

Concavity::Concavity(const VoxelSolid& solid, double unit, double cost)
    : solid_(solid), unit_(unit), cost_(cost) {
  outside_.spacing = solid.spacing;
  outside_.origin = solid.origin + Eigen::Vector3d::Constant(solid.spacing / 2);
  outside_.dims = solid.dims;
  outside_.values.assign(static_cast<std::size_t>(solid.dims[0]) * solid.dims[1] * solid.dims[2],
                         INFINITY);
  NearestSurface(solid, outside_).Run();
}

Concavity::Fit Concavity::FitOf(const TriMesh& hull, const std::vector<int>& voxels) const {
  Fit fit = Depth(hull, voxels);
  fit.distance = std::max(fit.distance, StickOut(hull));
  return fit;
}

double Concavity::CostOf(double distance) const { return cost_ * std::pow(distance / unit_, 3); }

double Concavity::StickOut(const TriMesh& hull) const {
  double most = 0;
  for (const auto& [a, b, c] : hull.triangles) {
    const Eigen::Vector3d &p = hull.vertices[a], u = hull.vertices[b] - p, v = hull.vertices[c] - p;
    const double length = std::max({u.norm(), v.norm(), (u - v).norm()});
    const int steps = static_cast<int>(std::ceil(length / (kSampleVoxels * solid_.spacing)));
    for (int i = 0; i < steps; ++i)
      for (int j = 0; i + j < steps; ++j)
        most = std::max(most,
                        outside_.Sample(p + (i + 1.0 / 3) / steps * u + (j + 1.0 / 3) / steps * v));
  }
  return most;
}

Concavity::Fit Concavity::Depth(const TriMesh& hull, const std::vector<int>& voxels) const {
  std::vector<Eigen::Vector4d> planes;
  for (const auto& [a, b, c] : hull.triangles) {
    const Eigen::Vector3d& p = hull.vertices[a];
    const Eigen::Vector3d normal = (hull.vertices[b] - p).cross(hull.vertices[c] - p).normalized();
    planes.emplace_back(normal.x(), normal.y(), normal.z(), normal.dot(p));
  }
  Fit most;
  for (const int i : voxels) {
    if (solid_.voxels[i].inner()) continue;
    const Eigen::Vector3d& p = solid_.voxels[i].on_surface;
    double depth = INFINITY;
    for (std::size_t f = 0; f < planes.size() && depth > most.distance; ++f)
      depth = std::min(depth, planes[f].w() - planes[f].head<3>().dot(p));
    if (depth > most.distance) most = {depth, i};
  }
  return most;
}

}  // namespace dexremoe
