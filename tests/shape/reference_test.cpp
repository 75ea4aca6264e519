// The network against a second one, written apart from it: point by point in double, with the
// original's padding of balls and none of the code of lib/shape but the trained numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "shape/shape_net.h"
#include "shapes.h"

namespace dexremoe {
namespace {

using Row = std::vector<double>;

double SquaredDistance(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return sum;
}

// A cloud's points, each with what the network knows of it so far.
struct Points {
  std::vector<Eigen::Vector3d> place;
  std::vector<Row> feature;
};

class Reference {
 public:
  explicit Reference(const ShapeNet& net) : net_(net), sizes_(net.net.sizes()) {}

  // p and the logits.
  std::pair<Row, Row> Run(const std::vector<Eigen::Vector3f>& cloud) const {
    Points points = UnitSphere(cloud);
    points = Abstract(points, sizes_.level1, "sa1", static_cast<int>(sizes_.widths1.size()));
    points = Abstract(points, sizes_.level2, "sa2", static_cast<int>(sizes_.widths2.size()));
    Row global;
    for (std::size_t i = 0; i < points.place.size(); ++i)
      TakeLarger(Layers("sa3", static_cast<int>(sizes_.widths3.size()),
                        Joined(points.place[i], points.feature[i])),
                 global);
    Row p = Layer("feature/0", Layers("head", static_cast<int>(sizes_.head.size()), global));
    for (double& value : p) value = value > 0 ? value : std::exp(value) - 1;
    return {p, Layer("classifier/0", p)};
  }

 private:
  Points UnitSphere(const std::vector<Eigen::Vector3f>& cloud) const {
    Eigen::Vector3d middle(0, 0, 0);
    for (const auto& p : cloud) middle += p.cast<double>();
    middle /= static_cast<double>(cloud.size());
    double radius = 0;
    for (const auto& p : cloud)
      radius = std::max(radius, std::sqrt(SquaredDistance(p.cast<double>(), middle)));
    Points points;
    for (const auto& p : cloud) points.place.push_back((p.cast<double>() - middle) / radius);
    points.feature.resize(cloud.size());
    return Chosen(points, Farthest(points.place, std::min<int>(sizes_.points, cloud.size())));
  }

  // Greedy farthest points; the first is the one farthest from the origin, the middle of all.
  static std::vector<int> Farthest(const std::vector<Eigen::Vector3d>& place, int count) {
    std::vector<int> chosen;
    while (static_cast<int>(chosen.size()) < count) {
      int best = -1;
      double best_distance = -1;
      for (int i = 0; i < static_cast<int>(place.size()); ++i) {
        double nearest = chosen.empty() ? place[i].squaredNorm() : 1e9;
        for (const int c : chosen) nearest = std::min(nearest, SquaredDistance(place[i], place[c]));
        if (nearest > best_distance) {
          best = i;
          best_distance = nearest;
        }
      }
      chosen.push_back(best);
    }
    return chosen;
  }

  static Points Chosen(const Points& points, const std::vector<int>& which) {
    Points chosen;
    for (const int i : which) {
      chosen.place.push_back(points.place[i]);
      chosen.feature.push_back(points.feature[i]);
    }
    return chosen;
  }

  Points Abstract(const Points& points, const GroupSizes& sizes, const std::string& name,
                  int layers) const {
    const int centroids = std::min<int>(sizes.centroids, points.place.size());
    Points result;
    for (int g = 0; g < centroids; ++g) {
      const Eigen::Vector3d& center = points.place[g];
      std::vector<int> ball;
      for (int i = 0; i < static_cast<int>(points.place.size()); ++i)
        if (std::sqrt(SquaredDistance(points.place[i], center)) <= sizes.radius) ball.push_back(i);
      ball.resize(sizes.neighbors, ball[0]);  // cut off or padded with the first
      Row largest;
      for (const int i : ball)
        TakeLarger(Layers(name, layers,
                          Joined((points.place[i] - center) / sizes.radius, points.feature[i])),
                   largest);
      result.place.push_back(center);
      result.feature.push_back(largest);
    }
    return result;
  }

  static Row Joined(const Eigen::Vector3d& place, const Row& feature) {
    Row row = {place.x(), place.y(), place.z()};
    row.insert(row.end(), feature.begin(), feature.end());
    return row;
  }

  static void TakeLarger(const Row& row, Row& largest) {
    if (largest.empty()) largest = row;
    for (std::size_t j = 0; j < row.size(); ++j) largest[j] = std::max(largest[j], row[j]);
  }

  Row Layers(const std::string& name, int layers, Row row) const {
    for (int layer = 0; layer < layers; ++layer) {
      row = Layer(name + "/" + std::to_string(layer), row);
      for (double& value : row) value = std::max(value, 0.0);
    }
    return row;
  }

  Row Layer(const std::string& name, const Row& x) const {
    const ParamBlock& weight = net_.layout.block(net_.layout.Find(name + "/weight"));
    const ParamBlock& bias = net_.layout.block(net_.layout.Find(name + "/bias"));
    Row y;
    for (std::int64_t j = 0; j < weight.rows; ++j) {
      double sum = net_.params[bias.offset + j];
      for (std::int64_t i = 0; i < weight.cols; ++i)
        sum += net_.params[weight.offset + j * weight.cols + i] * x[i];
      y.push_back(sum);
    }
    return y;
  }

  const ShapeNet& net_;
  const PointNetSizes& sizes_;
};

TEST(PointNet, MatchesAnIndependentSlowReference) {
  PointNetSizes sizes;
  sizes.points = 160;
  sizes.level1 = {48, 0.35, 12};
  sizes.level2 = {16, 0.7, 20};
  sizes.widths1 = {8, 12};
  sizes.widths2 = {12, 16};
  sizes.widths3 = {16, 24};
  sizes.head = {20, 16};
  ShapeNet net(sizes);
  Rng rng(11, Stream::kInit);
  InitializeOnRandomClouds(net, rng);
  for (std::uint64_t i = 0; i < 3; ++i) {
    // The last cloud has fewer points than the network takes.
    const auto cloud = RandomCloud(i < 2 ? 200 : 90, 60 + i, {1, 0.6f, 0.3f});
    const ShapeDescriptor ours = DescribeShape(net, cloud);
    const auto [p, logits] = Reference(net).Run(cloud);
    ASSERT_EQ(ours.feature.size(), p.size());
    ASSERT_EQ(ours.logits.size(), logits.size());
    for (std::size_t j = 0; j < p.size(); ++j) EXPECT_NEAR(ours.feature[j], p[j], 2e-4) << j;
    for (std::size_t j = 0; j < logits.size(); ++j)
      EXPECT_NEAR(ours.logits[j], logits[j], 2e-4) << j;
  }
}

}  // namespace
}  // namespace dexremoe
