#include "geometry/cluster.h"

#include <algorithm>
#include <climits>
#include <cstdint>
#include <optional>
#include <unordered_map>

#include "base/check.h"
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


// Extreme points of each layer of voxels along `axis`; hulls of halves are built from these.
struct Layers {
  int first = 0;  // cell index of the first layer
  std::vector<Points> points;
  std::vector<double> solid;  // m^3
};

Layers LayersAlong(const VoxelSolid& solid, const Cluster& cluster, int axis) {
  std::vector<std::vector<int>> members;
  Layers layers;
  int low = INT_MAX, high = INT_MIN;
  for (const int i : cluster.voxels) {
    low = std::min(low, solid.voxels[i].cell[axis]);
    high = std::max(high, solid.voxels[i].cell[axis]);
  }
  layers.first = low;
  members.resize(high - low + 1);
  layers.solid.resize(members.size(), 0);
  for (const int i : cluster.voxels) {
    members[solid.voxels[i].cell[axis] - low].push_back(i);
    layers.solid[solid.voxels[i].cell[axis] - low] += solid.voxels[i].volume;
  }
  for (const std::vector<int>& layer : members) {
    Points points = ClusterPoints(solid, layer, axis, true);
    std::optional<HullSummary> hull = SummariseHull(points);
    layers.points.push_back(hull ? std::move(hull->vertices) : std::move(points));
  }
  return layers;
}

// Hull volumes of the layers from one end up to each, grown layer by layer.
std::vector<double> GrowingHulls(const Layers& layers, bool from_high) {
  const std::size_t n = layers.points.size();
  std::vector<double> volumes(n);
  Points points;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t layer = from_high ? n - 1 - k : k;
    points.insert(points.end(), layers.points[layer].begin(), layers.points[layer].end());
    std::optional<HullSummary> hull = SummariseHull(points);
    volumes[layer] = hull ? hull->volume : 0;
    if (hull) points = std::move(hull->vertices);
  }
  return volumes;
}

struct Plane {
  int axis = -1;
  int cell = 0;  // the high side starts with this layer
  double score = INFINITY;
};

void ConsiderAxis(const VoxelSolid& solid, const Cluster& cluster, int axis, double balance,
                  Plane& best) {
  const Layers layers = LayersAlong(solid, cluster, axis);
  const int n = static_cast<int>(layers.points.size());
  if (n < 2) return;
  const std::vector<double> low = GrowingHulls(layers, false), high = GrowingHulls(layers, true);
  double low_solid = 0;
  for (int k = 1; k < n; ++k) {
    low_solid += layers.solid[k - 1];
    const double high_solid = cluster.solid - low_solid;
    const double score =
        low[k - 1] + high[k] - cluster.solid + balance * std::abs(low_solid - high_solid);
    if (score < best.score) best = {axis, layers.first + k, score};
  }
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

}  // namespace

TriMesh SolidHull(const Points& points, double thickness) {
  if (auto hull = ConvexHull(points, {0, thickness})) return *hull;
  Points padded;
  for (const Eigen::Vector3d& p : points)
    for (int corner = 0; corner < 8; ++corner)
      padded.push_back(p + thickness / 2 * Eigen::Vector3d(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1,
                                                           corner & 4 ? 1 : -1));
  auto hull = ConvexHull(padded);
  DEX_CHECK(hull.has_value());
  return *hull;
}

Cluster MakeCluster(const VoxelSolid& solid, std::vector<int> voxels) {
  DEX_CHECK(!voxels.empty());
  Cluster cluster;
  cluster.voxels = std::move(voxels);
  for (const int i : cluster.voxels) cluster.solid += solid.voxels[i].volume;
  cluster.hull =
      SolidHull(ClusterPoints(solid, cluster.voxels, 2, false), solid.spacing / 10);
  cluster.hull_volume = MassPropertiesOf(cluster.hull).volume;
  return cluster;
}

std::vector<Cluster> CutBest(const VoxelSolid& solid, const Cluster& cluster, double balance) {
  Plane plane;
  for (int axis = 0; axis < 3; ++axis) ConsiderAxis(solid, cluster, axis, balance, plane);
  if (plane.axis < 0) return {cluster};
  std::array<std::vector<int>, 2> sides;
  for (const int i : cluster.voxels)
    sides[solid.voxels[i].cell[plane.axis] >= plane.cell].push_back(i);
  std::vector<Cluster> pieces;
  for (const std::vector<int>& side : sides)
    for (std::vector<int>& group : Connected(solid, side))
      pieces.push_back(MakeCluster(solid, std::move(group)));
  return pieces;
}

void MergeClusters(std::size_t most, double free_volume, double thickness,
                   std::vector<Cluster>& clusters) {
  const auto corners = [](const Cluster& a, const Cluster& b) {
    Points points = a.hull.vertices;
    points.insert(points.end(), b.hull.vertices.begin(), b.hull.vertices.end());
    return points;
  };
  const auto cost = [&](const Cluster& a, const Cluster& b) {
    const auto hull = SummariseHull(corners(a, b));
    return (hull ? hull->volume : 0) - a.hull_volume - b.hull_volume;
  };
  std::vector<std::vector<double>> costs(clusters.size());
  for (std::size_t i = 0; i < clusters.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) costs[i].push_back(cost(clusters[i], clusters[j]));
  while (clusters.size() > 1) {
    std::size_t a = 1, b = 0;
    for (std::size_t i = 1; i < clusters.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (costs[i][j] < costs[a][b]) a = i, b = j;
    if (clusters.size() <= most && costs[a][b] > free_volume) break;
    clusters[b].hull = SolidHull(corners(clusters[a], clusters[b]), thickness);
    clusters[b].hull_volume = MassPropertiesOf(clusters[b].hull).volume;
    clusters[b].solid += clusters[a].solid;
    clusters[b].voxels.insert(clusters[b].voxels.end(), clusters[a].voxels.begin(),
                              clusters[a].voxels.end());
    clusters.erase(clusters.begin() + static_cast<std::ptrdiff_t>(a));
    costs.erase(costs.begin() + static_cast<std::ptrdiff_t>(a));
    for (std::size_t i = a; i < costs.size(); ++i)
      costs[i].erase(costs[i].begin() + static_cast<std::ptrdiff_t>(a));
    for (std::size_t j = 0; j < b; ++j) costs[b][j] = cost(clusters[b], clusters[j]);
    for (std::size_t i = b + 1; i < clusters.size(); ++i)
      costs[i][b] = cost(clusters[i], clusters[b]);
  }
}

}  // namespace dexremoe
