// The network: gradients, equivalence with the padded original, invariances.
#include "shape/pointnet2.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "nn/gradient_check.h"
#include "nn/kernels.h"
#include "shape/shape_net.h"
#include "shapes.h"

namespace dexremoe {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

PointNetSizes SmallSizes() {
  PointNetSizes sizes;
  sizes.points = 48;
  sizes.level1 = {16, 0.5, 8};
  sizes.level2 = {6, 0.9, 6};
  sizes.widths1 = {5, 6};
  sizes.widths2 = {7, 8};
  sizes.widths3 = {9, 10};
  sizes.head = {8, 7};
  sizes.feature = 5;
  sizes.categories = 3;
  return sizes;
}

ShapeNet RandomNet(const PointNetSizes& sizes, std::uint64_t seed) {
  ShapeNet net(sizes);
  Rng rng(seed, Stream::kInit);
  InitializeOnRandomClouds(net, rng);
  // Biases too, so that their gradients are exercised away from zero.
  for (const ParamBlock& block : net.layout.blocks())
    if (block.cols == 1)
      for (std::int64_t i = 0; i < block.size(); ++i)
        net.params[block.offset + i] = static_cast<float>(rng.Uniform(-0.2, 0.2));
  return net;
}

TEST(PointNet, GradientMatchesCentralDifferences) {
  const ShapeNet net = RandomNet(SmallSizes(), 1);
  std::vector<GroupedCloud> clouds;
  for (int i = 0; i < 2; ++i) clouds.push_back(net.net.Group(RandomCloud(60, 20 + i)));
  const std::vector<double> params(net.params.begin(), net.params.end());
  const std::vector<double> seed = {0.7, -1.1, 0.4, -0.3, 0.9, 1.3};
  const auto loss = [&](const std::vector<double>& at) {
    PointNetWorkspace<double> work;
    net.net.Forward<double>(at.data(), clouds, work);
    double sum = 0;
    for (std::size_t i = 0; i < seed.size(); ++i) sum += seed[i] * work.logits[i];
    return sum;
  };
  PointNetWorkspace<double> work;
  net.net.Forward<double>(params.data(), clouds, work);
  std::vector<double> dlogits = seed, grads(params.size(), 0.0);
  net.net.Backward<double>(params.data(), clouds, dlogits.data(), work, grads.data());
  // A step small enough to cross none of the kinks of ReLU and maximum.
  const GradientReport report = CheckGradient(loss, params, grads, 1e-6, 1e-6);
  EXPECT_TRUE(report.ok) << report.Text();
  EXPECT_GT(std::count_if(grads.begin(), grads.end(), [](double g) { return g != 0; }),
            static_cast<std::ptrdiff_t>(grads.size() / 2));
}

TEST(PointNet, BackwardAddsAndFloatMatchesDouble) {
  const ShapeNet net = RandomNet(SmallSizes(), 2);
  const std::vector<GroupedCloud> clouds = {net.net.Group(RandomCloud(60, 30))};
  const std::vector<double> params(net.params.begin(), net.params.end());
  PointNetWorkspace<double> work;
  PointNetWorkspace<float> work_f;
  net.net.Forward<double>(params.data(), clouds, work);
  net.net.Forward<float>(net.params.data(), clouds, work_f);
  for (int j = 0; j < 3; ++j) EXPECT_NEAR(work_f.logits[j], work.logits[j], 1e-5);
  std::vector<double> grads(params.size(), 0.0);
  std::vector<float> grads_f(params.size(), 0.0f);
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<double> dlogits = {1, -2, 0.5};
    std::vector<float> dlogits_f = {1, -2, 0.5};
    if (pass == 0)
      net.net.Backward<double>(params.data(), clouds, dlogits.data(), work, grads.data());
    net.net.Backward<float>(net.params.data(), clouds, dlogits_f.data(), work_f, grads_f.data());
  }
  for (std::size_t i = 0; i < grads.size(); ++i)
    EXPECT_NEAR(grads_f[i], 2 * grads[i], 1e-4 * (1 + std::abs(grads[i])));
}

TEST(PointNet, GradientInBfloat16PointsWhereTheExactOneDoes) {
  PointNetSizes sizes = SmallSizes();
  sizes.widths3 = {32, 64};
  const ShapeNet net = RandomNet(sizes, 9);
  std::vector<GroupedCloud> clouds;
  for (int i = 0; i < 4; ++i) clouds.push_back(net.net.Group(RandomCloud(60, 70 + i)));
  const std::vector<double> params(net.params.begin(), net.params.end());
  std::vector<BFloat16> stored(params.size());
  Cast(std::ssize(net.params), net.params.data(), stored.data());
  PointNetWorkspace<double> work;
  PointNetWorkspace<BFloat16> work_b;
  net.net.Forward<double>(params.data(), clouds, work);
  net.net.Forward<BFloat16>(stored.data(), clouds, work_b);
  const std::vector<double> dlogits = {1, -2, 0.5, 0.3, 0.2, -0.7, 1.1, 0.4, -0.9, -0.6, 0.8, 0.1};
  const std::vector<float> dlogits_f(dlogits.begin(), dlogits.end());
  std::vector<double> grads(params.size(), 0.0);
  std::vector<float> grads_b(params.size(), 0.0f);
  net.net.Backward<double>(params.data(), clouds, dlogits.data(), work, grads.data());
  net.net.Backward<BFloat16>(stored.data(), clouds, dlogits_f.data(), work_b, grads_b.data());
  double inner = 0, square = 0, square_b = 0;
  for (std::size_t i = 0; i < grads.size(); ++i) {
    inner += grads[i] * grads_b[i];
    square += grads[i] * grads[i];
    square_b += double{grads_b[i]} * grads_b[i];
  }
  EXPECT_GT(inner / std::sqrt(square * square_b), 0.98);
  EXPECT_NEAR(std::sqrt(square_b / square), 1, 0.05);
  for (std::size_t j = 0; j < work.logits.size(); ++j)
    EXPECT_NEAR(work_b.logits[j], work.logits[j], 0.05 * (1 + std::abs(work.logits[j])));
}

// The original pads each ball with copies of its first point; leaving them out changes nothing.
GroupedCloud Padded(const GroupedCloud& cloud, const PointNetSizes& sizes) {
  const auto pad = [](const Groups& groups, int neighbors) {
    Groups result;
    result.begin.push_back(0);
    for (int g = 0; g < groups.count(); ++g) {
      for (int n = 0; n < neighbors; ++n) {
        const int row =
            groups.begin[g] + n < groups.begin[g + 1] ? groups.begin[g] + n : groups.begin[g];
        result.index.push_back(groups.index[row]);
        for (int k = 0; k < 3; ++k) result.local.push_back(groups.local[3 * row + k]);
      }
      result.begin.push_back(result.rows());
    }
    return result;
  };
  return {pad(cloud.level1, sizes.level1.neighbors), pad(cloud.level2, sizes.level2.neighbors),
          cloud.centers};
}

TEST(PointNet, LeavingOutThePaddingChangesNeitherOutputNorGradient) {
  const PointNetSizes sizes = SmallSizes();
  const ShapeNet net = RandomNet(sizes, 3);
  const GroupedCloud cloud = net.net.Group(RandomCloud(60, 40));
  const GroupedCloud padded = Padded(cloud, sizes);
  ASSERT_GT(padded.level1.rows(), cloud.level1.rows());
  const std::vector<double> params(net.params.begin(), net.params.end());
  std::vector<double> logits[2], grads[2];
  for (const bool pad : {false, true}) {
    PointNetWorkspace<double> work;
    const GroupedCloud& used = pad ? padded : cloud;
    net.net.Forward<double>(params.data(), {&used, 1}, work);
    logits[pad] = work.logits;
    grads[pad].assign(params.size(), 0.0);
    std::vector<double> dlogits = {1, 2, -3};
    net.net.Backward<double>(params.data(), {&used, 1}, dlogits.data(), work, grads[pad].data());
  }
  for (int j = 0; j < 3; ++j) EXPECT_NEAR(logits[0][j], logits[1][j], 1e-12);
  for (std::size_t i = 0; i < params.size(); ++i) EXPECT_NEAR(grads[0][i], grads[1][i], 1e-11);
}

TEST(DescribeShape, DoesNotDependOnTheOrderOfThePointsOrTheUnit) {
  PointNetSizes sizes;
  sizes.widths3 = {64, 128};
  const ShapeNet net = RandomNet(sizes, 4);
  auto points = RandomCloud(1024, 50);
  const ShapeDescriptor first = DescribeShape(net, points);
  ASSERT_EQ(first.feature.size(), 100u);
  ASSERT_EQ(first.logits.size(), 6u);
  Rng rng(5, Stream::kTest);
  for (std::size_t i = points.size(); i > 1; --i) std::swap(points[i - 1], points[rng.Index(i)]);
  const ShapeDescriptor shuffled = DescribeShape(net, points);
  for (int i = 0; i < 100; ++i) EXPECT_NEAR(shuffled.feature[i], first.feature[i], 1e-5);
  for (Eigen::Vector3f& p : points) p *= 0.125f;  // a power of two: no rounding
  const ShapeDescriptor scaled = DescribeShape(net, points);
  for (int i = 0; i < 100; ++i) EXPECT_NEAR(scaled.feature[i], shuffled.feature[i], 1e-5);
}

TEST(DescribeShape, OfASignalNeitherVanishesNorExplodesAtTheStart) {
  const PointNetSizes sizes;
  ShapeNet net(sizes);
  Rng rng(6, Stream::kInit);
  InitializeOnRandomClouds(net, rng);
  const ShapeDescriptor descriptor = DescribeShape(net, RandomCloud(1024, 51));
  double square = 0;
  for (const float value : descriptor.feature) square += value * value / 100.0;
  EXPECT_GT(square, 0.01);
  EXPECT_LT(square, 1000);
}

TEST(DescribeRotated, EqualsDescribingRotatedCloudsForEveryNumberOfWorkers) {
  PointNetSizes sizes;
  sizes.points = 128;
  sizes.level1 = {64, 0.3, 16};
  sizes.level2 = {16, 0.6, 16};
  const ShapeNet net = RandomNet(sizes, 7);
  const auto points = RandomCloud(200, 52);
  std::vector<Eigen::Quaternionf> rotations;
  Rng rng(8, Stream::kTest);
  for (int i = 0; i < 9; ++i) {
    const auto [w, x, y, z] = rng.UnitQuaternion();
    rotations.push_back(Eigen::Quaterniond(w, x, y, z).cast<float>());
  }
  ThreadPool one(1), three(3);
  const auto alone = DescribeRotated(net, points, rotations, one);
  const auto together = DescribeRotated(net, points, rotations, three);
  for (int i = 0; i < 9; ++i) {
    std::vector<Eigen::Vector3f> rotated;
    for (const Eigen::Vector3f& p : points) rotated.push_back(rotations[i].toRotationMatrix() * p);
    EXPECT_EQ(alone[i].feature, DescribeShape(net, rotated).feature);
    EXPECT_EQ(alone[i].feature, together[i].feature);
    EXPECT_EQ(alone[i].logits, together[i].logits);
  }
}

TEST(PointNetSizes, RefusesWhatCannotBe) {
  PointNetSizes sizes;
  sizes.level2.centroids = 600;
  EXPECT_THAT([&] { ShapeNet net(sizes); },
              ThrowsMessage<Error>(HasSubstr("shape.sa2_centroids: expected at most the 512")));
  sizes = PointNetSizes();
  sizes.widths2 = {64, 0};
  EXPECT_THAT([&] { ShapeNet net(sizes); }, ThrowsMessage<Error>(HasSubstr("shape.sa2_widths")));
}

}  // namespace
}  // namespace dexremoe
