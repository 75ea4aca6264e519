// What bench_shape counts, on networks whose answers are known.
#include "eval/shape_bench.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"

namespace dexremoe {
namespace {

PointNetSizes TinySizes() {
  PointNetSizes sizes;
  sizes.points = 48;
  sizes.level1 = {16, 0.5, 8};
  sizes.level2 = {6, 0.9, 8};
  sizes.widths1 = {16};
  sizes.widths2 = {16};
  sizes.widths3 = {32};
  sizes.head = {32};
  return sizes;
}

std::vector<Eigen::Vector3f> Cloud(std::uint64_t index, const Eigen::Vector3f& size) {
  Rng rng(1, Stream::kTest, {index});
  std::vector<Eigen::Vector3f> points(60);
  for (Eigen::Vector3f& p : points)
    for (int k = 0; k < 3; ++k) p[k] = size[k] * static_cast<float>(rng.Uniform(-1, 1));
  return points;
}

// A network that takes everything for the category `answer`.
ShapeNet Stubborn(int answer) {
  ShapeNet net(TinySizes());
  Rng rng(2, Stream::kInit);
  const GroupedCloud cloud = net.net.Group(Cloud(9, {1, 1, 1}));
  net.net.Initialize(rng, {&cloud, 1}, net.params.data());
  const ParamBlock& bias = net.layout.block(net.layout.Find("classifier/0/bias"));
  net.params[bias.offset + answer] = 1e4f;
  return net;
}

// Two sticks of category 1 and a ball of category 4.
ShapeSet SticksAndBall() {
  ShapeSet set;
  set.name = "sticks and ball";
  set.clouds = {{"stick", 1, Cloud(0, {1, 0.1f, 0.1f}), ""},
                {"other stick", 1, Cloud(1, {1, 0.12f, 0.1f}), ""},
                {"ball", 4, Cloud(2, {1, 1, 1}), ""}};
  set.resampled = set.clouds;
  return set;
}

TEST(StudyShapes, CountsWhatIsToldRightByObjectAndCategory) {
  ThreadPool pool(1);
  const ShapeStudy sticks = StudyShapes<float>(Stubborn(1), SticksAndBall(), 3, 1, pool);
  EXPECT_NEAR(sticks.accuracy, 2.0 / 3, 1e-12);
  EXPECT_NEAR(sticks.always, 2.0 / 3, 1e-12);
  EXPECT_EQ(sticks.by_category[1], 1);
  EXPECT_EQ(sticks.by_category[4], 0);
  EXPECT_TRUE(std::isnan(sticks.by_category[0]));
  EXPECT_NEAR(sticks.error, 1.96 * std::sqrt(2.0 / 9 / 3), 1e-12);
}

TEST(StudyShapes, TheSamePointsAreNoDistanceApartAndOtherShapesAre) {
  ThreadPool pool(2);
  const ShapeStudy study = StudyShapes<float>(Stubborn(1), SticksAndBall(), 4, 1, pool);
  EXPECT_NEAR(study.resampled, 0, 1e-6);
  EXPECT_GT(study.rotated, 1e-4);
  EXPECT_GT(study.other_category, study.same_category);
}

TEST(StudyShapes, DoesNotDependOnTheWorkersAndRefusesAnEmptySet) {
  ThreadPool one(1), three(3);
  const ShapeStudy a = StudyShapes<BFloat16>(Stubborn(4), SticksAndBall(), 5, 7, one);
  const ShapeStudy b = StudyShapes<BFloat16>(Stubborn(4), SticksAndBall(), 5, 7, three);
  EXPECT_EQ(a.rotated, b.rotated);
  EXPECT_EQ(a.other_category, b.other_category);
  EXPECT_THAT(
      [&] {
        StudyShapes<float>(Stubborn(1), {"nothing", {}, {}}, 3, 1, one);
      },
      testing::ThrowsMessage<Error>(testing::HasSubstr("nothing")));
}

TEST(ShapeBench, ShowsEverySetInEveryPrecision) {
  ShapeBenchOptions options;
  options.sizes = TinySizes();
  options.train.epochs = 1;
  options.train.epoch_clouds = 4;
  const ShapeSet set = SticksAndBall();
  ThreadPool pool(1);
  std::vector<ShapeBenchResult> reports;
  RunShapeBench(options, {set.clouds, {}, {}}, {set}, {"f32"}, pool,
                [&](const ShapeBenchResult& result) { reports.push_back(result); });
  ASSERT_EQ(reports.size(), 1u);
  EXPECT_THAT(reports[0].Markdown(), testing::HasSubstr("sticks and ball (3), f32"));
  EXPECT_THAT(CsvOf(reports[0].measurements), testing::HasSubstr("training,f32,processor s,"));
}

}  // namespace
}  // namespace dexremoe
