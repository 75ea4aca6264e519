#include <algorithm>
#include <cmath>

#include "geometry/cluster.h"
#include "geometry/hull.h"

namespace dexremoe {
namespace {

using Points = std::vector<Eigen::Vector3d>;

bool Near(const Cluster& a, const Cluster& b, double reach) {
  const Box3 box_a = BoundsOf(a.hull), box_b = BoundsOf(b.hull);
  return (box_a.min.array() <= box_b.max.array() + reach).all() &&
         (box_b.min.array() <= box_a.max.array() + reach).all();
}

Cluster Join(const Cluster& a, const Cluster& b, double thickness) {
  Cluster joint;
  Points points = a.hull.vertices;
  points.insert(points.end(), b.hull.vertices.begin(), b.hull.vertices.end());
  joint.hull = SolidHull(points, thickness);
  joint.hull_volume = MassPropertiesOf(joint.hull).volume;
  joint.solid = a.solid + b.solid;
  joint.voxels = a.voxels;
  joint.voxels.insert(joint.voxels.end(), b.voxels.begin(), b.voxels.end());
  return joint;
}

// What joining each pair of clusters would cost. Concavity is the dearer half to find out: it is
// added to a pair only when the pair is the cheapest without it.
class JoiningCosts {
 public:
  JoiningCosts(const std::vector<Cluster>& clusters, double reach, const Concavity& concavity)
      : clusters_(clusters), reach_(reach), concavity_(concavity), costs_(clusters.size()) {
    for (std::size_t i = 0; i < clusters.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) costs_[i].push_back(VolumeCost(i, j));
  }
  struct Pair {
    std::size_t a = 1, b = 0;  // a > b
    double cost = 0;
  };
  Pair Cheapest() {
    while (true) {
      Pair best;
      for (std::size_t i = 1; i < costs_.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
          if (costs_[i][j].value < costs_[best.a][best.b].value) best = {i, j};
      Cost& cost = costs_[best.a][best.b];
      best.cost = cost.value;
      if (cost.complete) return best;
      cost.value += ConcavityCost(clusters_[best.a], clusters_[best.b]);
      cost.complete = true;
    }
  }
  // Cluster `a` is no more, its number taken up by those behind; `b` has changed.
  void Update(std::size_t a, std::size_t b) {
    costs_.erase(costs_.begin() + static_cast<std::ptrdiff_t>(a));
    for (std::size_t i = a; i < costs_.size(); ++i)
      costs_[i].erase(costs_[i].begin() + static_cast<std::ptrdiff_t>(a));
    for (std::size_t j = 0; j < b; ++j) costs_[b][j] = VolumeCost(b, j);
    for (std::size_t i = b + 1; i < costs_.size(); ++i) costs_[i][b] = VolumeCost(i, b);
  }

 private:
  struct Cost {
    double value = INFINITY;  // m^3
    bool complete = true;     // concavity included
  };
  Cost VolumeCost(std::size_t i, std::size_t j) const {
    const Cluster &a = clusters_[i], &b = clusters_[j];
    if (!Near(a, b, reach_)) return {};
    Points points = a.hull.vertices;
    points.insert(points.end(), b.hull.vertices.begin(), b.hull.vertices.end());
    return {HullVolume(points) - a.hull_volume - b.hull_volume + SharedVolume(a.hull, b.hull),
            false};
  }
  double ConcavityCost(const Cluster& a, const Cluster& b) const {
    const Cluster joint = Join(a, b, reach_ / 10);
    return std::max(0.0, concavity_.CostOf(concavity_.FitOf(joint.hull, joint.voxels).distance) -
                             std::max(a.concavity, b.concavity));
  }
  const std::vector<Cluster>& clusters_;
  double reach_;
  const Concavity& concavity_;
  std::vector<std::vector<Cost>> costs_;  // [i][j], j < i
};

}  // namespace

void MergeClusters(std::size_t most, double free_cost, double reach, const Concavity& concavity,
                   std::vector<Cluster>& clusters) {
  JoiningCosts costs(clusters, reach, concavity);
  while (clusters.size() > 1) {
    const auto [a, b, cost] = costs.Cheapest();
    if (clusters.size() <= most && cost > free_cost) break;
    clusters[b] = Join(clusters[b], clusters[a], reach / 10);
    clusters[b].concavity =
        concavity.CostOf(concavity.FitOf(clusters[b].hull, clusters[b].voxels).distance);
    clusters.erase(clusters.begin() + static_cast<std::ptrdiff_t>(a));
    costs.Update(a, b);
  }
}

}  // namespace dexremoe
