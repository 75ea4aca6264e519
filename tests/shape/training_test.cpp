// Augmentation, training and the files of the network.
#include "shape/training.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "io/atomic_file.h"
#include "nn/precision.h"
#include "shape/cloud.h"
#include "shape/grouping.h"
#include "shape/shape_files.h"
#include "shapes.h"

namespace dexremoe {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::string TemporaryPath(const std::string& name) { return ::testing::TempDir() + name; }

PointNetSizes TinySizes() {
  PointNetSizes sizes;
  sizes.points = 64;
  sizes.level1 = {32, 0.4, 12};
  sizes.level2 = {8, 0.8, 12};
  sizes.widths1 = {16, 16};
  sizes.widths2 = {16, 32};
  sizes.widths3 = {32, 64};
  sizes.head = {32};
  return sizes;
}

LabelledCloud Surface(const std::string& name, int category, const TriMesh& mesh) {
  CloudOptions options;
  options.points = 96;
  std::vector<Eigen::Vector3f> points;
  for (const Eigen::Vector3d& p : SampleCloud(mesh, options, 1).points)
    points.push_back(p.cast<float>());
  return {name, category, ToUnitSphere(points), ""};
}

// Two easy categories: sticks and balls; other sticks and balls are held out.
LabelledClouds SticksAndBalls() {
  LabelledClouds clouds;
  clouds.train = {Surface("stick", 1, BoxMesh({0.01, 0.012, 0.08})),
                  Surface("thick stick", 1, BoxMesh({0.02, 0.015, 0.08})),
                  Surface("ball", 4, SphereMesh(0.03, 16)),
                  Surface("block", 4, BoxMesh({0.05, 0.055, 0.06}))};
  clouds.held_out = {Surface("other stick", 1, BoxMesh({0.015, 0.015, 0.07})),
                     Surface("other block", 4, BoxMesh({0.05, 0.05, 0.05}))};
  return clouds;
}

ShapeTrainOptions ShortTraining() {
  ShapeTrainOptions options;
  options.epochs = 60;
  options.epoch_clouds = 32;
  options.batch = 8;
  options.rate = 3e-3;
  options.evaluate_every = 30;
  return options;
}

TEST(AugmentCloud, WithoutDeformationIsARotation) {
  const auto points = RandomCloud(50, 1);
  const AugmentOptions options = {0, 0, 0, 0};
  Rng rng(1, Stream::kAugment);
  const auto variant = AugmentCloud(points, options, rng);
  ASSERT_EQ(variant.size(), points.size());
  double moved = 0;
  for (int i = 0; i < 50; ++i) {
    EXPECT_NEAR(variant[i].norm(), points[i].norm(), 1e-5);
    for (int j = 0; j < i; ++j)
      EXPECT_NEAR((variant[i] - variant[j]).norm(), (points[i] - points[j]).norm(), 1e-5);
    moved = std::max<double>(moved, (variant[i] - points[i]).norm());
  }
  EXPECT_GT(moved, 0.1);
}

TEST(AugmentCloud, RotatesDirectionsUniformly) {
  const std::vector<Eigen::Vector3f> points = RandomCloud(4, 2);
  const AugmentOptions options = {0, 0, 0, 0};
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  const int count = 4000;
  for (int i = 0; i < count; ++i) {
    Rng rng(3, Stream::kAugment, {static_cast<std::uint64_t>(i)});
    const Eigen::Vector3d u = AugmentCloud(points, options, rng)[0].cast<double>().normalized();
    sum += u / count;
    second += u * u.transpose() / count;
  }
  // Standard errors: 1/sqrt(3 n) = .009 for the mean; about .005 for the second moments.
  EXPECT_LT(sum.norm(), 0.04);
  EXPECT_LT((second - Eigen::Matrix3d::Identity() / 3).norm(), 0.04);
}

TEST(AugmentCloud, ThinsJittersAndStretchesWithinTheirBounds) {
  const auto points = RandomCloud(1000, 3);
  Rng rng(4, Stream::kAugment);
  double smallest = 1;
  for (int i = 0; i < 50; ++i) {
    const double kept = AugmentCloud(points, {0, 0.5, 0, 0}, rng).size() / 1000.0;
    EXPECT_GT(kept, 0.42);
    smallest = std::min(smallest, kept);
  }
  EXPECT_LT(smallest, 0.65);
  const std::vector<Eigen::Vector3f> origin(2000, Eigen::Vector3f::Zero());
  double square = 0, largest = 0;
  for (const Eigen::Vector3f& p : AugmentCloud(origin, {0, 0, 0.01, 0.025}, rng)) {
    square += p.squaredNorm() / 6000.0;
    largest = std::max<double>(largest, p.cwiseAbs().maxCoeff());
  }
  EXPECT_NEAR(std::sqrt(square), 0.01, 0.001);
  EXPECT_NEAR(largest, 0.025, 1e-8);
  EXPECT_GE(AugmentCloud(RandomCloud(5, 4), {0, 0.95, 0, 0}, rng).size(), 4u);
}

class TrainShapeIn : public ::testing::TestWithParam<std::string> {};

TEST_P(TrainShapeIn, TellsSticksFromBalls) {
  const LabelledClouds clouds = SticksAndBalls();
  ShapeNet net(TinySizes());
  ThreadPool pool(2);
  ShapeTrainOptions options = ShortTraining();
  options.precision = GetParam();
  const ShapeTraining training = TrainShape(clouds, options, 1, pool, net);
  const ShapeCurve& curve = training.curve;
  ASSERT_EQ(curve.loss.size(), 60u);
  EXPECT_GT(curve.loss.front(), 0.3);
  EXPECT_LT(curve.loss.back(), 0.1);
  EXPECT_GT(curve.train_accuracy.back(), 0.95);
  EXPECT_TRUE(std::isnan(curve.held_out_accuracy[0]));
  EXPECT_GT(curve.held_out_accuracy.back(), 0.9);
  EXPECT_LT(curve.rate.back(), 0.2 * curve.rate.front());
  EXPECT_EQ(training.held_out.Accuracy(), curve.held_out_accuracy.back());
  const ShapeTrial trial = TryShapes(net, clouds.held_out, 20, 2, pool);
  EXPECT_GT(trial.Accuracy(), 0.9);
  int total = 0, diagonal = 0;
  for (int i = 0; i < 36; ++i) {
    total += trial.confusion[i];
    if (i % 7 == 0) diagonal += trial.confusion[i];
  }
  EXPECT_EQ(total, 40);
  EXPECT_NEAR(trial.Accuracy(), diagonal / 40.0, 1e-12);
}

TEST_P(TrainShapeIn, BitsDependOnTheSeedAndNotOnTheWorkers) {
  const LabelledClouds clouds = SticksAndBalls();
  ShapeTrainOptions options = ShortTraining();
  options.precision = GetParam();
  options.epochs = 2;
  const auto train = [&](int workers, std::uint64_t seed) {
    ShapeNet net(TinySizes());
    ThreadPool pool(workers);
    TrainShape(clouds, options, seed, pool, net);
    return net.params;
  };
  const auto reference = train(1, 5);
  EXPECT_EQ(train(2, 5), reference);
  EXPECT_EQ(train(4, 5), reference);
  EXPECT_NE(train(1, 6), reference);
}

INSTANTIATE_TEST_SUITE_P(Precision, TrainShapeIn, ::testing::ValuesIn(NativePrecisions()),
                         [](const auto& info) { return info.param; });

// Cosine distance of two descriptors.
double Apart(const ShapeDescriptor& a, const ShapeDescriptor& b) {
  const Eigen::Map<const Eigen::VectorXf> p(a.feature.data(), std::ssize(a.feature)),
      q(b.feature.data(), std::ssize(b.feature));
  return 1 - p.dot(q) / (p.norm() * q.norm());
}

TEST(DescribeShape, ChangesLittleWhenTheSurfaceIsSampledAnew) {
  ShapeNet net(TinySizes());
  ThreadPool pool(2);
  TrainShape(SticksAndBalls(), ShortTraining(), 3, pool, net);
  CloudOptions options;
  options.points = 96;
  const auto describe = [&](const TriMesh& mesh, std::uint64_t seed) {
    std::vector<Eigen::Vector3f> points;
    for (const Eigen::Vector3d& p : SampleCloud(mesh, options, seed).points)
      points.push_back(p.cast<float>());
    return DescribeShape(net, points);
  };
  const TriMesh stick = BoxMesh({0.015, 0.015, 0.07}), ball = SphereMesh(0.03, 16);
  const double apart = Apart(describe(stick, 1), describe(ball, 1));
  for (std::uint64_t seed = 2; seed < 8; ++seed) {
    EXPECT_LT(Apart(describe(stick, 1), describe(stick, seed)), 0.1 * apart);
    EXPECT_LT(Apart(describe(ball, 1), describe(ball, seed)), 0.1 * apart);
  }
}

TEST(ShapeFiles, NetworkAndDescriptorSurviveARoundTrip) {
  ShapeNet net(TinySizes());
  Rng rng(7, Stream::kInit);
  InitializeOnRandomClouds(net, rng);
  const std::string path = TemporaryPath("shape_net.h5"), shape = TemporaryPath("shape.h5");
  const ShapeCurve curve = {{1, 2}, {0.1, 0.1}, {1.5, 1.2}, {0.2, 0.4}, {NAN, 0.5}};
  const ShapeTrial trial = {{"cube"}, {0.75}, std::vector<std::int32_t>(36, 1)};
  WriteShapeNet(path, net, {curve, trial, "bf16"}, {"test", "", 1, {}});
  const ShapeNet read = ReadShapeNet(path);
  EXPECT_EQ(read.params, net.params);
  const auto points = RandomCloud(80, 5);
  const ShapeDescriptor descriptor = DescribeShape(net, points);
  EXPECT_EQ(DescribeShape(read, points).feature, descriptor.feature);
  WriteShape(shape, descriptor, {"test", "", 1, {}});
  EXPECT_EQ(ReadShape(shape).feature, descriptor.feature);
  EXPECT_EQ(ReadShape(shape).logits, descriptor.logits);
  EXPECT_EQ(H5Reader(shape, kShapeFormat).ReadValues<float>("probabilities", {6}),
            CategoryProbabilities(descriptor));
  const H5Reader file(path, kShapeNetFormat);
  EXPECT_EQ(file.ReadScalar<double>("held_out/accuracy"), 0.75);
  EXPECT_EQ(file.ReadString("precision"), "bf16");
  EXPECT_EQ(file.ReadValues<double>("curve/loss", {2}), curve.loss);
  EXPECT_THAT(CurveCsv(curve), HasSubstr("\n2,0.1,1.2,0.4,0.5\n"));
}

TEST(LikelyCategories, NamesTheLikeliestFirstAndLeavesOutTheRest) {
  EXPECT_EQ(LikelyCategories({{}, {0, 0, 0, 0, 20, 0}}), "train 1.000");
  EXPECT_EQ(LikelyCategories({{}, {0, 20, 0, 0, 0, 21}}), "vehicle 0.731, animal 0.269");
}

TEST(ShapeFiles, RefuseOtherFormatsAndWeightsThatAreNotFinite) {
  const std::string path = TemporaryPath("bad_net.h5");
  ShapeNet net(TinySizes());
  const ShapeTrial nothing = {{}, {}, std::vector<std::int32_t>(36, 0)};
  net.params[3] = NAN;
  WriteShapeNet(path, net, {{}, nothing, "f32"}, {"test", "", 1, {}});
  EXPECT_THAT([&] { ReadShapeNet(path); },
              ThrowsMessage<Error>(
                  AllOf(HasSubstr(path), HasSubstr("weights/sa1/0/weight"), HasSubstr("finite"))));
  EXPECT_THAT([&] { ReadShape(path); }, ThrowsMessage<Error>(HasSubstr("dexremoe.shape")));
  EXPECT_THROW(ReadShapeNet(TemporaryPath("absent.h5")), Error);
}

TEST(ReadLabelledClouds, NamesTheFileAndTheFieldThatIsWrong) {
  const std::string folder = TemporaryPath("objects/cube"), csv = TemporaryPath("objects.csv");
  CloudOptions options;
  options.points = 32;
  const PointCloud cloud = SampleCloud(BoxMesh({0.05, 0.05, 0.05}), options, 1);
  WriteCloud(folder + "/cloud.h5", cloud, {"test", "", 1, {}});
  const auto read = [&](const std::string& category, const std::string& split,
                        const std::string& place) {
    WriteFile(csv, "name,category,split,mesh,folder,grasps\ncube," + category + "," + split +
                       ",cube.ply," + place + ",g.h5\n");
    return ReadLabelledClouds(csv);
  };
  const LabelledClouds good = read("shoe", "train", folder);
  ASSERT_EQ(good.train.size(), 1u);
  EXPECT_EQ(good.train[0].category, 3);
  float radius = 0;
  for (const Eigen::Vector3f& p : good.train[0].points) radius = std::max(radius, p.norm());
  EXPECT_NEAR(radius, 1, 1e-6);
  EXPECT_THAT([&] { read("boat", "train", folder); },
              ThrowsMessage<Error>(AllOf(HasSubstr(csv), HasSubstr("found 'boat'"))));
  EXPECT_THAT([&] { read("shoe", "test", folder); },
              ThrowsMessage<Error>(AllOf(HasSubstr(csv), HasSubstr("found 'test'"))));
  EXPECT_THAT([&] { read("shoe", "ood", folder); },
              ThrowsMessage<Error>(HasSubstr("split 'train', found none")));
  EXPECT_THAT([&] { read("shoe", "train", folder + "/nowhere"); },
              ThrowsMessage<Error>(HasSubstr("nowhere/cloud.h5")));
}

}  // namespace
}  // namespace dexremoe
