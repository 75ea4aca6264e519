// Farthest points, balls and pooling.
#include "shape/grouping.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pcl/filters/farthest_point_sampling.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "base/error.h"
#include "nn/kernels.h"
#include "shape/farthest.h"
#include "shape/max_pool.h"
#include "shapes.h"

namespace dexremoe {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::vector<float> Flat(const std::vector<Eigen::Vector3f>& points) {
  std::vector<float> xyz;
  for (const Eigen::Vector3f& p : points) xyz.insert(xyz.end(), p.data(), p.data() + 3);
  return xyz;
}

TEST(FarthestPointOrder, StartsFarthestFromTheCentroidAndPicksTheFarthestNext) {
  const auto points = RandomCloud(200, 1);
  const auto order = FarthestPointOrder(Flat(points), 60);
  Eigen::Vector3f centroid = Eigen::Vector3f::Zero();
  for (const auto& p : points) centroid += p / 200;
  for (const auto& p : points)
    EXPECT_LE((p - centroid).norm(), (points[order[0]] - centroid).norm() + 1e-6);
  std::vector<float> nearest(200, INFINITY);
  for (std::size_t k = 1; k < order.size(); ++k) {
    for (int i = 0; i < 200; ++i)
      nearest[i] = std::min(nearest[i], (points[i] - points[order[k - 1]]).squaredNorm());
    EXPECT_GE(nearest[order[k]], *std::max_element(nearest.begin(), nearest.end()) * (1 - 1e-6f));
  }
}

TEST(FarthestPointOrder, ShorterOrdersArePrefixes) {
  const auto xyz = Flat(RandomCloud(150, 2));
  const auto whole = FarthestPointOrder(xyz, 150);
  const auto part = FarthestPointOrder(xyz, 40);
  EXPECT_EQ(part, std::vector<int>(whole.begin(), whole.begin() + 40));
  EXPECT_EQ(std::set<int>(whole.begin(), whole.end()).size(), 150u);
}

// Why one order serves both levels of the network.
TEST(FarthestPointOrder, OfItsOwnPrefixIsThePrefix) {
  const auto points = RandomCloud(300, 3);
  std::vector<Eigen::Vector3f> first;
  for (const int i : FarthestPointOrder(Flat(points), 100)) first.push_back(points[i]);
  std::vector<int> expected(100);
  std::iota(expected.begin(), expected.end(), 0);
  EXPECT_EQ(FarthestPointOrder(Flat(first), 100, 0), expected);
}

TEST(FarthestPointOrder, MatchesPclFromPclsStart) {
  const auto points = RandomCloud(500, 4);
  auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  for (const auto& p : points) cloud->push_back(pcl::PointXYZ(p.x(), p.y(), p.z()));
  pcl::FarthestPointSampling<pcl::PointXYZ> sampling;
  sampling.setInputCloud(cloud);
  sampling.setSample(80);
  sampling.setSeed(3);
  pcl::Indices theirs;
  sampling.filter(theirs);
  EXPECT_EQ(FarthestPointOrder(Flat(points), 80, theirs[0]),
            std::vector<int>(theirs.begin(), theirs.end()));
}

TEST(FarthestPointOrder, TakesEveryCopyOfAPointOnce) {
  std::vector<Eigen::Vector3f> points(6, Eigen::Vector3f(1, 2, 3));
  points[4] = {0, 0, 0};
  auto order = FarthestPointOrder(Flat(points), 6);
  EXPECT_EQ(order[0], 4);
  std::sort(order.begin(), order.end());
  EXPECT_EQ(order, (std::vector<int>{0, 1, 2, 3, 4, 5}));
}

TEST(BallQuery, MatchesBruteForce) {
  const auto points = RandomCloud(250, 5);
  const GroupSizes sizes = {40, 0.3, 12};
  const Groups groups = BallQuery(Flat(points), sizes);
  ASSERT_EQ(groups.count(), 40);
  int full = 0, partial = 0;
  for (int g = 0; g < 40; ++g) {
    std::vector<int> expected;
    for (int i = 0; i < 250 && expected.size() < 12; ++i)
      if ((points[i] - points[g]).norm() <= 0.3f) expected.push_back(i);
    const std::vector<int> found(groups.index.begin() + groups.begin[g],
                                 groups.index.begin() + groups.begin[g + 1]);
    EXPECT_EQ(found, expected) << "group " << g;
    (found.size() == 12 ? full : partial) += 1;
  }
  EXPECT_GT(full, 0);
  EXPECT_GT(partial, 0);
  for (int row = groups.begin[7]; row < groups.begin[8]; ++row)
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(groups.local[3 * row + k], (points[groups.index[row]][k] - points[7][k]) / 0.3f,
                  1e-6);
}

TEST(BallQuery, EveryGroupHoldsItsCentroid) {
  const auto xyz = Flat(RandomCloud(60, 6));
  const Groups groups = BallQuery(xyz, {60, 1e-4, 8});
  for (int g = 0; g < 60; ++g) {
    EXPECT_EQ(groups.begin[g + 1] - groups.begin[g], 1);
    EXPECT_EQ(groups.index[groups.begin[g]], g);
  }
}

TEST(GroupCloud, DoesNotDependOnUnitPositionOrOrderOfThePoints) {
  auto points = RandomCloud(120, 7);
  const GroupSizes one = {32, 0.4, 8}, two = {8, 0.8, 16};
  const GroupedCloud cloud = GroupCloud(points, 96, one, two);
  EXPECT_EQ(cloud.level1.count(), 32);
  EXPECT_EQ(cloud.level2.count(), 8);
  std::reverse(points.begin(), points.end());
  const GroupedCloud shuffled = GroupCloud(points, 96, one, two);
  EXPECT_EQ(shuffled.level1.index, cloud.level1.index);
  EXPECT_EQ(shuffled.level2.index, cloud.level2.index);
  for (Eigen::Vector3f& p : points) p = 0.25f * p + Eigen::Vector3f(0.5f, -1, 2);
  const GroupedCloud moved = GroupCloud(points, 96, one, two);
  ASSERT_EQ(moved.level2.index, cloud.level2.index);
  for (std::size_t i = 0; i < cloud.level2.local.size(); ++i)
    EXPECT_NEAR(moved.level2.local[i], cloud.level2.local[i], 1e-5);
}

TEST(GroupCloud, RefusesCloudsThatAreNone) {
  const GroupSizes one = {32, 0.4, 8}, two = {8, 0.8, 16};
  EXPECT_THAT([&] { GroupCloud(RandomCloud(3, 8), 96, one, two); },
              ThrowsMessage<Error>(HasSubstr("at least 4 points, found 3")));
  EXPECT_THAT(
      [&] { GroupCloud(std::vector<Eigen::Vector3f>(9, Eigen::Vector3f(1, 1, 1)), 96, one, two); },
      ThrowsMessage<Error>(HasSubstr("not all equal")));
  auto points = RandomCloud(20, 9);
  points[5].y() = NAN;
  EXPECT_THAT([&] { GroupCloud(points, 96, one, two); }, ThrowsMessage<Error>(HasSubstr("finite")));
}

TEST(MaxPool, EveryTypeMatchesBruteForceAndTheFirstOfEqualsWins) {
  const std::vector<int> begin = {0, 3, 4, 9};
  const int k = 37;
  Rng rng(19, Stream::kTest);
  std::vector<double> y(9 * k);
  // Many equal values; bfloat16 holds them exactly.
  for (double& value : y) value = static_cast<double>(rng.Index(5)) - 2;
  const std::vector<float> yf(y.begin(), y.end());
  std::vector<BFloat16> yb(9 * k), pooled_b(3 * k);
  Cast(9 * k, yf.data(), yb.data());
  std::vector<double> pooled(3 * k);
  std::vector<float> pooled_f(3 * k);
  std::vector<std::int32_t> winner(3 * k), winner_f(3 * k), winner_b(3 * k);
  MaxPoolForward(begin, k, y.data(), pooled.data(), winner.data());
  MaxPoolForward(begin, k, yf.data(), pooled_f.data(), winner_f.data());
  MaxPoolForward(begin, k, yb.data(), pooled_b.data(), winner_b.data());
  for (int g = 0; g < 3; ++g)
    for (int j = 0; j < k; ++j) {
      int best = begin[g];
      for (int row = begin[g]; row < begin[g + 1]; ++row)
        if (y[row * k + j] > y[best * k + j]) best = row;
      EXPECT_EQ(winner[g * k + j], best);
      EXPECT_EQ(winner_f[g * k + j], best);
      EXPECT_EQ(winner_b[g * k + j], best);
      EXPECT_EQ(pooled[g * k + j], y[best * k + j]);
      EXPECT_EQ(pooled_f[g * k + j], yf[best * k + j]);
      EXPECT_EQ(pooled_b[g * k + j].bits, yb[best * k + j].bits);
    }
}

}  // namespace
}  // namespace dexremoe
