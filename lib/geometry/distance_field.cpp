#include "geometry/distance_field.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/check.h"

namespace dexremoe {
namespace {

// Side of the blocks, in cells, whose inside may be settled by their corners.
constexpr int kBlock = 4;

// Distances row by row; the triangle nearest to the node before is likely to be near this one.
void FillDistance(const TriangleBvh& surface, DistanceGrid& grid) {
  std::vector<int> row_hint(grid.dims[0], -1);
  for (int z = 0; z < grid.dims[2]; ++z)
    for (int y = 0; y < grid.dims[1]; ++y)
      for (int x = 0; x < grid.dims[0]; ++x) {
        const SurfacePoint nearest = surface.Closest(grid.Position(x, y, z), row_hint[x]);
        grid.values[grid.Index(x, y, z)] = nearest.distance;
        row_hint[x] = nearest.triangle;
      }
}

// Decides inside or outside for every node. The winding number is smooth away from the surface, so
// a block without surface whose corners agree clearly is settled by them.
class SignFill {
 public:
  SignFill(const TriangleBvh& surface, DistanceGrid& grid)
      : surface_(surface), grid_(grid), winding_(grid.values.size(), NAN) {}

  void Run() {
    for (int z = 0; z < grid_.dims[2]; z += kBlock)
      for (int y = 0; y < grid_.dims[1]; y += kBlock)
        for (int x = 0; x < grid_.dims[0]; x += kBlock) FillBlock({x, y, z});
    for (std::size_t i = 0; i < grid_.values.size(); ++i)
      if (winding_[i] > 0.5) grid_.values[i] = -grid_.values[i];
  }

 private:
  double Winding(int x, int y, int z) {
    double& w = winding_[grid_.Index(x, y, z)];
    if (std::isnan(w)) w = surface_.WindingNumber(grid_.Position(x, y, z));
    return w;
  }

  void FillBlock(const std::array<int, 3>& low) {
    std::array<int, 3> high;
    for (int k = 0; k < 3; ++k) high[k] = std::min(low[k] + kBlock, grid_.dims[k] - 1);
    // The nearest corner is within half a diagonal of any point of the block, so distances beyond a
    // diagonal at all corners keep the surface out.
    double least = INFINITY, lowest = INFINITY, highest = -INFINITY;
    for (int corner = 0; corner < 8; ++corner) {
      const int x = corner & 1 ? high[0] : low[0], y = corner & 2 ? high[1] : low[1],
                z = corner & 4 ? high[2] : low[2];
      least = std::min(least, grid_.values[grid_.Index(x, y, z)]);
      lowest = std::min(lowest, Winding(x, y, z));
      highest = std::max(highest, Winding(x, y, z));
    }
    const bool free = least > std::sqrt(3.0) / 2 * kBlock * grid_.spacing;
    const bool settled = free && (highest < 0.3 || lowest > 0.7);
    for (int z = low[2]; z <= high[2]; ++z)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int x = low[0]; x <= high[0]; ++x) {
          if (settled)
            winding_[grid_.Index(x, y, z)] = lowest;
          else
            Winding(x, y, z);
        }
  }

  const TriangleBvh& surface_;
  DistanceGrid& grid_;
  std::vector<double> winding_;
};

}  // namespace

double DistanceGrid::Sample(const Eigen::Vector3d& p) const {
  std::array<int, 3> cell;
  std::array<double, 3> t;
  for (int k = 0; k < 3; ++k) {
    const double at = std::clamp((p[k] - origin[k]) / spacing, 0.0, dims[k] - 1.0);
    cell[k] = std::min(static_cast<int>(at), dims[k] - 2);
    t[k] = at - cell[k];
  }
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const int dx = corner & 1, dy = corner >> 1 & 1, dz = corner >> 2;
    const double weight = (dx ? t[0] : 1 - t[0]) * (dy ? t[1] : 1 - t[1]) * (dz ? t[2] : 1 - t[2]);
    sum += weight * values[Index(cell[0] + dx, cell[1] + dy, cell[2] + dz)];
  }
  return sum;
}

DistanceGrid GridAround(const Box3& bounds, int resolution, int margin) {
  DEX_CHECK_GT(resolution, 0);
  const Eigen::Vector3d size = bounds.Size();
  DEX_CHECK_GT(size.maxCoeff(), 0);
  DistanceGrid grid;
  grid.spacing = size.maxCoeff() / resolution;
  for (int k = 0; k < 3; ++k) {
    const int cells = static_cast<int>(std::ceil(size[k] / grid.spacing - 1e-9)) + 2 * margin;
    grid.dims[k] = std::max(cells, 1) + 1;
    grid.origin[k] = bounds.Center()[k] - grid.spacing * (grid.dims[k] - 1) / 2;
  }
  grid.values.assign(static_cast<std::size_t>(grid.dims[0]) * grid.dims[1] * grid.dims[2], 0);
  return grid;
}

void FillSignedDistance(const TriangleBvh& surface, DistanceGrid& grid) {
  FillDistance(surface, grid);
  SignFill(surface, grid).Run();
}

}  // namespace dexremoe
