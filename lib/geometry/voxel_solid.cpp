#include "geometry/voxel_solid.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "geometry/triangle_bvh.h"

namespace dexremoe {
namespace {

using Polygon = std::vector<Eigen::Vector3d>;  // in voxel units from the grid's origin

// The part of a convex polygon with coordinate `axis` on one side of `plane` (Sutherland, Hodgman).
Polygon Clip(const Polygon& polygon, int axis, double plane, bool keep_above) {
  Polygon kept;
  const auto outside = [&](const Eigen::Vector3d& p) {
    return keep_above ? plane - p[axis] : p[axis] - plane;
  };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d& a = polygon[i];
    const Eigen::Vector3d& b = polygon[(i + 1) % polygon.size()];
    const double da = outside(a), db = outside(b);
    if (da <= 0) kept.push_back(a);
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
      kept.push_back(a + da / (da - db) * (b - a));
      kept.back()[axis] = plane;
    }
  }
  return kept;
}

// Calls body(cell, piece) for each slab of `axis` that the polygon passes through. A polygon that
// lies in a slab's boundary belongs to the slab above.
template <typename Body>
void ForEachSlab(const Polygon& polygon, int axis, const Body& body) {
  double low = INFINITY, high = -INFINITY;
  for (const Eigen::Vector3d& p : polygon) {
    low = std::min(low, p[axis]);
    high = std::max(high, p[axis]);
  }
  const int first = static_cast<int>(std::floor(low));
  const int last = std::max(first, static_cast<int>(std::ceil(high)) - 1);
  for (int cell = first; cell <= last; ++cell) {
    Polygon piece = cell > first ? Clip(polygon, axis, cell, true) : polygon;
    if (cell < last) piece = Clip(piece, axis, cell + 1, false);
    if (piece.size() >= 3) body(cell, piece);
  }
}

// States of a cell that the surface does not pass through.
constexpr int kEmpty = -1;
constexpr int kInner = -2;

// What the surface leaves in one voxel while the triangles are cut up.
struct Cut {
  Polygon points;
  double area = 0;    // projected on z = const, upward facing positive; voxel units
  double moment = 0;  // the same times the height above the voxel's floor
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // of the piece with most corners
  std::size_t corners = 0;                           // of that piece
};

void AddPiece(const Polygon& piece, double floor, Cut& cut) {
  for (std::size_t i = 1; i + 1 < piece.size(); ++i) {
    const Eigen::Vector3d &a = piece[0], &b = piece[i], &c = piece[i + 1];
    const double area = ((b.x() - a.x()) * (c.y() - a.y()) - (c.x() - a.x()) * (b.y() - a.y())) / 2;
    cut.area += area;
    cut.moment += area * ((a.z() + b.z() + c.z()) / 3 - floor);
  }
  cut.points.insert(cut.points.end(), piece.begin(), piece.end());
  if (piece.size() <= cut.corners) return;
  cut.corners = piece.size();
  cut.middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : piece) cut.middle += p / static_cast<double>(piece.size());
}

// Exactly equal points once, then those extreme in one of 26 directions moved to the front.
// Returns their number.
int SortOut(Polygon& points) {
  std::sort(points.begin(), points.end(), [](const auto& p, const auto& q) {
    return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  std::vector<char> extreme(points.size(), 0);
  for (int code = 0; code < 27; ++code) {
    const Eigen::Vector3d direction(code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1);
    if (direction.squaredNorm() == 2) continue;
    std::size_t best = 0;
    for (std::size_t i = 1; i < points.size(); ++i)
      if (direction.dot(points[i]) > direction.dot(points[best])) best = i;
    extreme[best] = 1;
  }
  Polygon sorted;
  for (const char wanted : {1, 0})
    for (std::size_t i = 0; i < points.size(); ++i)
      if (extreme[i] == wanted) sorted.push_back(points[i]);
  points = std::move(sorted);
  return static_cast<int>(std::count(extreme.begin(), extreme.end(), 1));
}

class Voxeliser {
 public:
  Voxeliser(const TriMesh& mesh, int resolution) : mesh_(mesh), surface_(mesh) {
    const Box3 bounds = BoundsOf(mesh);
    const Eigen::Vector3d size = bounds.Size();
    solid_.spacing = VoxelSize(bounds, resolution);
    for (int k = 0; k < 3; ++k) {
      // More than a voxel to spare, by a fraction that keeps faces of boxes off the voxels' faces.
      solid_.dims[k] = static_cast<int>(std::ceil(size[k] / solid_.spacing + 1.3));
      solid_.origin[k] = bounds.Center()[k] - (solid_.dims[k] / 2.0 + 0.0137) * solid_.spacing;
    }
    cut_of_cell_.assign(static_cast<std::size_t>(solid_.dims[0]) * solid_.dims[1] * solid_.dims[2],
                        kEmpty);
  }

  VoxelSolid Run() {
    for (const auto& triangle : mesh_.triangles) {
      Polygon polygon;
      for (const int v : triangle)
        polygon.push_back((mesh_.vertices[v] - solid_.origin) / solid_.spacing);
      ForEachSlab(polygon, 0, [&](int x, const Polygon& slab) {
        ForEachSlab(slab, 1, [&](int y, const Polygon& column) {
          ForEachSlab(column, 2, [&](int z, const Polygon& piece) {
            AddPiece(piece, z, CutAt({x, y, z}));
          });
        });
      });
    }
    FillColumns();
    for (Voxel& voxel : solid_.voxels) TakePoints(voxel);
    return std::move(solid_);
  }

 private:
  std::size_t Index(const std::array<int, 3>& cell) const {
    return (static_cast<std::size_t>(cell[2]) * solid_.dims[1] + cell[1]) * solid_.dims[0] +
           cell[0];
  }
  Cut& CutAt(const std::array<int, 3>& cell) {
    for (int k = 0; k < 3; ++k) {
      DEX_CHECK_GE(cell[k], 0);
      DEX_CHECK_LT(cell[k], solid_.dims[k]);
    }
    int& index = cut_of_cell_[Index(cell)];
    if (index < 0) {
      index = static_cast<int>(cuts_.size());
      cuts_.emplace_back();
    }
    return cuts_[index];
  }

  // Along each column from below, the covered share of the voxel faces changes by the projected
  // area of the surface pieces; the volume of a voxel is its covered ceiling times the height, plus
  // the moments of the pieces.
  void FillColumns() {
    std::vector<double> covered(static_cast<std::size_t>(solid_.dims[0]) * solid_.dims[1], 0);
    const double unit = std::pow(solid_.spacing, 3);
    for (int z = 0; z < solid_.dims[2]; ++z)
      for (int y = 0; y < solid_.dims[1]; ++y)
        for (int x = 0; x < solid_.dims[0]; ++x) {
          const int index = cut_of_cell_[Index({x, y, z})];
          double& ceiling = covered[static_cast<std::size_t>(y) * solid_.dims[0] + x];
          if (index < 0 && ceiling < 0.5) continue;
          Voxel voxel = {{x, y, z}};
          double share = ceiling;
          if (index >= 0) {
            ceiling -= cuts_[index].area;
            share = ceiling + cuts_[index].moment;
          } else {
            cut_of_cell_[Index(voxel.cell)] = kInner;
          }
          voxel.volume = unit * std::clamp(share, 0.0, 1.0);
          solid_.volume += voxel.volume;
          solid_.voxels.push_back(voxel);
        }
  }

  // Whether a node of the grid is in the solid. Nodes next to an empty or an inner voxel are known.
  bool NodeInside(const std::array<int, 3>& node) {
    for (int side = 0; side < 8; ++side) {
      const std::array<int, 3> cell = {node[0] - (side & 1), node[1] - (side >> 1 & 1),
                                       node[2] - (side >> 2)};
      bool within = true;
      for (int k = 0; k < 3; ++k) within = within && cell[k] >= 0 && cell[k] < solid_.dims[k];
      const int state = within ? cut_of_cell_[Index(cell)] : kEmpty;
      if (state < 0) return state == kInner;
    }
    return surface_.WindingNumber(solid_.Corner(node)) > 0.5;
  }

  // The surface pieces' corners and those corners of the voxel that are in the solid.
  void TakePoints(Voxel& voxel) {
    const int index = cut_of_cell_[Index(voxel.cell)];
    if (index < 0) return;
    Polygon points = std::move(cuts_[index].points);
    voxel.on_surface = solid_.origin + solid_.spacing * cuts_[index].middle;
    for (int corner = 0; corner < 8; ++corner) {
      const std::array<int, 3> node = {voxel.cell[0] + (corner & 1),
                                       voxel.cell[1] + (corner >> 1 & 1),
                                       voxel.cell[2] + (corner >> 2)};
      if (NodeInside(node)) points.emplace_back(node[0], node[1], node[2]);
    }
    voxel.extreme = SortOut(points);
    voxel.first = static_cast<int>(solid_.points.size());
    voxel.count = static_cast<int>(points.size());
    for (const Eigen::Vector3d& p : points)
      solid_.points.push_back(solid_.origin + solid_.spacing * p);
  }

  const TriMesh& mesh_;
  const TriangleBvh surface_;
  VoxelSolid solid_;
  std::vector<int> cut_of_cell_;  // index into cuts_, kEmpty or kInner
  std::vector<Cut> cuts_;
};

}  // namespace

double VoxelSize(const Box3& bounds, int resolution) {
  // A flat box still needs a volume to divide.
  const Eigen::Vector3d size = bounds.Size().cwiseMax(1e-3 * bounds.Size().maxCoeff());
  return std::cbrt(size.prod() / resolution);
}

VoxelSolid Voxelise(const TriMesh& mesh, int resolution) {
  DEX_CHECK(!mesh.triangles.empty());
  return Voxeliser(mesh, resolution).Run();
}

}  // namespace dexremoe
