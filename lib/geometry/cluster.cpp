#include "geometry/cluster.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <unordered_map>

#include "base/check.h"
#include "geometry/growing_hull.h"
#include "geometry/hull.h"

namespace dexremoe {
namespace {

using Points = std::vector<Eigen::Vector3d>;

// Corners of the inner voxels that can lie on the hull: the ends of every row.
// `layer` is the axis along which the voxels are stacked; rows run along the next one.
void AppendInnerCorners(const VoxelSolid& solid, const std::vector<int>& voxels, int layer,
                        Points& points) {
  const int row = (layer + 1) % 3, across = (layer + 2) % 3;
  struct Ends {
    int low, high;
  };
  std::unordered_map<std::int64_t, Ends> rows;
  std::vector<std::int64_t> order;
  for (const int i : voxels) {
    const Voxel& voxel = solid.voxels[i];
    if (!voxel.inner()) continue;
    const std::int64_t key =
        static_cast<std::int64_t>(voxel.cell[layer]) << 32 | voxel.cell[across];
    const auto [at, fresh] = rows.emplace(key, Ends{voxel.cell[row], voxel.cell[row]});
    if (fresh) order.push_back(key);
    at->second.low = std::min(at->second.low, voxel.cell[row]);
    at->second.high = std::max(at->second.high, voxel.cell[row]);
  }
  for (const std::int64_t key : order) {
    std::array<int, 3> cell{};
    for (int corner = 0; corner < 8; ++corner) {
      cell[layer] = static_cast<int>(key >> 32) + (corner & 1);
      cell[across] = static_cast<int>(key & 0xFFFFFFFF) + (corner >> 1 & 1);
      cell[row] = corner & 4 ? rows[key].high + 1 : rows[key].low;
      points.push_back(solid.Corner(cell));
    }
  }
}

Points ClusterPoints(const VoxelSolid& solid, const std::vector<int>& voxels, int layer,
                     bool extreme_only) {
  Points points;
  for (const int i : voxels) {
    const Voxel& voxel = solid.voxels[i];
    const int count = extreme_only ? voxel.extreme : voxel.count;
    points.insert(points.end(), solid.points.begin() + voxel.first,
                  solid.points.begin() + voxel.first + count);
  }
  AppendInnerCorners(solid, voxels, layer, points);
  return points;
}

// Directions in which the extreme points of a layer are kept while planes are compared: the axes
// and diagonals of the grid and a Fibonacci sphere. One row of numbers per coordinate.
constexpr int kSpread = 38, kDirections = 26 + kSpread;
using PerDirection = Eigen::Array<float, kDirections, 1>;

const std::array<PerDirection, 3>& Directions() {
  static const std::array<PerDirection, 3> directions = [] {
    std::array<PerDirection, 3> rows;
    int count = 0;
    const auto add = [&](const Eigen::Vector3d& direction) {
      for (int k = 0; k < 3; ++k) rows[k][count] = static_cast<float>(direction[k]);
      ++count;
    };
    for (int code = 0; code < 27; ++code)
      if (code != 13)
        add(Eigen::Vector3d(code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1).normalized());
    for (int i = 0; i < kSpread; ++i) {
      const double z = 1 - (2 * i + 1.0) / kSpread, r = std::sqrt(1 - z * z);
      const double turn = i * std::numbers::pi * (3 - std::sqrt(5.0));
      add({r * std::cos(turn), r * std::sin(turn), z});
    }
    return rows;
  }();
  return directions;
}

// The extreme point of a set in each direction.
class Extremes {
 public:
  // Reaches are kept as 32-bit floats, which is enough near the origin.
  void Add(const Points& points, const Eigen::Vector3d& origin) {
    const auto& [x, y, z] = Directions();
    for (const Eigen::Vector3d& point : points) {
      const Eigen::Vector3f p = (point - origin).cast<float>();
      const PerDirection along = x * p.x() + y * p.y() + z * p.z();
      if ((along > reach_).any()) Take(along, [&](int) { return point; });
    }
  }
  void Add(const Extremes& other) {
    Take(other.reach_, [&](int d) { return other.points_[d]; });
  }
  double HullVolume() const {
    Points distinct = points_;
    std::sort(distinct.begin(), distinct.end(), [](const auto& p, const auto& q) {
      return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
    });
    distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
    return dexremoe::HullVolume(distinct);
  }

 private:
  template <typename PointIn>
  void Take(const PerDirection& along, const PointIn& point_in) {
    for (int d = 0; d < kDirections; ++d) {
      if (along[d] <= reach_[d]) continue;
      reach_[d] = along[d];
      points_[d] = point_in(d);
    }
  }
  Points points_ = Points(kDirections);
  PerDirection reach_ = PerDirection::Constant(-INFINITY);
};

// A cluster seen along one axis: what lies below and from each layer boundary on.
class Profile {
 public:
  Profile(const VoxelSolid& solid, const Cluster& cluster, int axis) {
    int low = INT_MAX, high = INT_MIN;
    for (const int i : cluster.voxels) {
      low = std::min(low, solid.voxels[i].cell[axis]);
      high = std::max(high, solid.voxels[i].cell[axis]);
    }
    first_ = low;
    std::vector<std::vector<int>> members(high - low + 1);
    for (const int i : cluster.voxels) members[solid.voxels[i].cell[axis] - low].push_back(i);
    for (const std::vector<int>& layer : members) {
      Extremes extremes;
      extremes.Add(ClusterPoints(solid, layer, axis, true), solid.origin);
      below_.push_back(extremes);
      above_.push_back(std::move(extremes));
      solid_below_.push_back(0);
      for (const int i : layer) solid_below_.back() += solid.voxels[i].volume;
    }
    for (int k = 1; k < layers(); ++k) {
      below_[k].Add(below_[k - 1]);
      solid_below_[k] += solid_below_[k - 1];
      above_[layers() - 1 - k].Add(above_[layers() - k]);
    }
  }
  int layers() const { return static_cast<int>(below_.size()); }
  int first() const { return first_; }

  // Score of the plane under layer k, 0 < k < layers().
  double Score(int k, double balance) const {
    const double low = solid_below_[k - 1], all = solid_below_.back();
    return below_[k - 1].HullVolume() + above_[k].HullVolume() - all +
           balance * std::abs(all - 2 * low);
  }

 private:
  int first_ = 0;                        // cell index of layer 0
  std::vector<Extremes> below_, above_;  // up to and with, from and with each layer
  std::vector<double> solid_below_;      // m^3, up to and with each layer
};

struct Plane {
  int axis = -1;
  int layer = 0;  // the high side starts with this layer
  double score = INFINITY;
};

// Every few layers first, then all around the best.
Plane FindBestPlane(const std::vector<Profile>& profiles, double balance) {
  Plane best;
  const auto consider = [&](int axis, int k) {
    const double score = profiles[axis].Score(k, balance);
    if (score < best.score) best = {axis, k, score};
  };
  const auto stride = [&](int axis) { return std::max(1, profiles[axis].layers() / 12); };
  for (int axis = 0; axis < 3; ++axis)
    for (int k = std::min(stride(axis), profiles[axis].layers() - 1);
         k > 0 && k < profiles[axis].layers(); k += stride(axis))
      consider(axis, k);
  if (best.axis < 0) return best;
  const Plane coarse = best;
  const int reach = stride(coarse.axis) - 1;
  for (int k = coarse.layer - reach; k <= coarse.layer + reach; ++k)
    if (k > 0 && k < profiles[coarse.axis].layers() && k != coarse.layer) consider(coarse.axis, k);
  return best;
}

// Groups of voxels that touch by a face, an edge or a corner.
std::vector<std::vector<int>> Connected(const VoxelSolid& solid, const std::vector<int>& voxels) {
  const auto key = [&](int x, int y, int z) {
    return (static_cast<std::int64_t>(z + 1) * (solid.dims[1] + 2) + y + 1) * (solid.dims[0] + 2) +
           x + 1;
  };
  std::unordered_map<std::int64_t, int> open;
  for (const int i : voxels) {
    const auto& c = solid.voxels[i].cell;
    open.emplace(key(c[0], c[1], c[2]), i);
  }
  std::vector<std::vector<int>> groups;
  for (const int seed : voxels) {
    const auto& s = solid.voxels[seed].cell;
    if (open.erase(key(s[0], s[1], s[2])) == 0) continue;
    std::vector<int> group = {seed};
    for (std::size_t i = 0; i < group.size(); ++i)
      for (int d = 0; d < 27; ++d) {
        const auto& c = solid.voxels[group[i]].cell;
        const auto found = open.find(key(c[0] + d % 3 - 1, c[1] + d / 3 % 3 - 1, c[2] + d / 9 - 1));
        if (found == open.end()) continue;
        group.push_back(found->second);
        open.erase(found);
      }
    std::sort(group.begin(), group.end());
    groups.push_back(std::move(group));
  }
  return groups;
}

// The high side starts with layer `first_high` of the grid.
std::vector<Cluster> CutAt(const VoxelSolid& solid, const Concavity& concavity,
                           const Cluster& cluster, int axis, int first_high) {
  std::array<std::vector<int>, 2> sides;
  for (const int i : cluster.voxels) sides[solid.voxels[i].cell[axis] >= first_high].push_back(i);
  std::vector<Cluster> pieces;
  for (const std::vector<int>& side : sides)
    for (std::vector<int>& group : Connected(solid, side))
      pieces.push_back(MakeCluster(solid, concavity, std::move(group)));
  return pieces;
}

double SummedCost(const std::vector<Cluster>& clusters) {
  double cost = 0;
  for (const Cluster& cluster : clusters) cost += cluster.Cost();
  return cost;
}

}  // namespace

TriMesh SolidHull(const Points& points, double thickness) {
  GrowingHull growing(points);
  growing.Grow();
  if (growing.solid()) return growing.Mesh();
  if (auto sheet = ConvexHull(points, {0, thickness})) return *sheet;
  Points padded;
  for (const Eigen::Vector3d& p : points)
    for (int corner = 0; corner < 8; ++corner)
      padded.push_back(
          p + thickness / 2 *
                  Eigen::Vector3d(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1));
  auto hull = ConvexHull(padded);
  DEX_CHECK(hull.has_value());
  return *hull;
}

Cluster MakeCluster(const VoxelSolid& solid, const Concavity& concavity, std::vector<int> voxels) {
  DEX_CHECK(!voxels.empty());
  Cluster cluster;
  cluster.voxels = std::move(voxels);
  for (const int i : cluster.voxels) cluster.solid += solid.voxels[i].volume;
  cluster.hull = SolidHull(ClusterPoints(solid, cluster.voxels, 2, true), solid.spacing / 10);
  cluster.hull_volume = MassPropertiesOf(cluster.hull).volume;
  const Concavity::Fit fit = concavity.FitOf(cluster.hull, cluster.voxels);
  cluster.concavity = concavity.CostOf(fit.distance);
  cluster.deepest = fit.deepest;
  return cluster;
}

std::vector<Cluster> CutBest(const VoxelSolid& solid, const Concavity& concavity,
                             const Cluster& cluster, double balance) {
  std::vector<Profile> profiles;
  for (int axis = 0; axis < 3; ++axis) profiles.emplace_back(solid, cluster, axis);
  const Plane plane = FindBestPlane(profiles, balance);
  if (plane.axis < 0) return {cluster};
  std::vector<Cluster> best =
      CutAt(solid, concavity, cluster, plane.axis, profiles[plane.axis].first() + plane.layer);
  if (cluster.deepest < 0) return best;
  const Eigen::Vector3d open =
      (solid.voxels[cluster.deepest].on_surface - solid.origin) / solid.spacing;
  for (int axis = 0; axis < 3; ++axis) {
    const int first_high = static_cast<int>(std::lround(open[axis]));
    const int layer = first_high - profiles[axis].first();
    if (layer <= 0 || layer >= profiles[axis].layers()) continue;
    std::vector<Cluster> pieces = CutAt(solid, concavity, cluster, axis, first_high);
    if (SummedCost(pieces) < SummedCost(best)) best = std::move(pieces);
  }
  return best;
}

TriMesh ExactHull(const VoxelSolid& solid, const Cluster& cluster) {
  return SolidHull(ClusterPoints(solid, cluster.voxels, 2, false), solid.spacing / 10);
}

}  // namespace dexremoe
