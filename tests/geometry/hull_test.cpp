#include "geometry/hull.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "geometry/growing_hull.h"
#include "shapes.h"

namespace dexremoe {
namespace {

std::vector<Eigen::Vector3d> Cloud(int count, std::uint64_t index) {
  Rng rng(1, Stream::kTest, {index});
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i)
    points.emplace_back(rng.Normal(), 0.5 * rng.Normal(), 2 * rng.Normal());
  return points;
}

TEST(ConvexHull, ContainsItsPointsAndIsConvexAndClosed) {
  for (std::uint64_t i = 0; i < 20; ++i) {
    const auto points = Cloud(200, i);
    const auto hull = ConvexHull(points);
    ASSERT_TRUE(hull);
    EXPECT_TRUE(TopologyOf(*hull).ClosedManifold());
    EXPECT_GT(MassPropertiesOf(*hull).volume, 0);
    EXPECT_TRUE(IsConvex(*hull, 1e-12));
    for (const auto& p : points) EXPECT_LE(DistanceOutside(*hull, p), 1e-12);
  }
}

TEST(ConvexHull, OfAHullIsTheSameHull) {
  const auto hull = ConvexHull(Cloud(300, 7));
  ASSERT_TRUE(hull);
  const auto again = ConvexHull(hull->vertices);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->vertices.size(), hull->vertices.size());
  EXPECT_NEAR(MassPropertiesOf(*again).volume, MassPropertiesOf(*hull).volume, 1e-12);
}

TEST(ConvexHull, OfAGridOfPointsIsItsBox) {
  std::vector<Eigen::Vector3d> grid;
  for (int i = 0; i < 125; ++i) grid.emplace_back(i % 5, i / 5 % 5, i / 25);
  const auto hull = ConvexHull(grid);
  ASSERT_TRUE(hull);
  EXPECT_TRUE(TopologyOf(*hull).ClosedManifold());
  EXPECT_NEAR(MassPropertiesOf(*hull).volume, 64, 1e-9);
}

TEST(ConvexHull, KeepsTheVertexLimitAndStaysClose) {
  const TriMesh sphere = SphereMesh(1, 24);
  double previous = 0;
  for (const int limit : {8, 16, 32, 64}) {
    const auto hull = ConvexHull(sphere.vertices, {limit, 0});
    ASSERT_TRUE(hull);
    EXPECT_LE(static_cast<int>(hull->vertices.size()), limit);
    EXPECT_TRUE(IsConvex(*hull, 1e-12));
    const double volume = MassPropertiesOf(*hull).volume;
    EXPECT_GT(volume, previous);
    previous = volume;
  }
  EXPECT_GT(previous, 0.85 * 4 / 3 * std::numbers::pi);
  // A box needs only its corners, however many points lie on it.
  std::vector<Eigen::Vector3d> grid;
  for (int i = 0; i < 125; ++i) grid.emplace_back(i % 5, i / 5 % 5, i / 25);
  EXPECT_NEAR(MassPropertiesOf(*ConvexHull(grid, {8, 0})).volume, 64, 1e-9);
}

TEST(GrowingHull, HasTheVolumeOfQhullsHull) {
  std::vector<std::vector<Eigen::Vector3d>> inputs = {SphereMesh(1, 24).vertices,
                                                      BoxMesh({0, 0, 0}, {1, 2, 3}).vertices};
  for (std::uint64_t i = 0; i < 40; ++i) inputs.push_back(Cloud(10 + 40 * static_cast<int>(i), i));
  for (const double tilt : {0.0, 0.3}) {  // many points on each face
    const Eigen::Matrix3d R =
        Eigen::AngleAxisd(tilt, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    inputs.emplace_back();
    for (int i = 0; i < 1000; ++i)
      inputs.back().push_back(R * Eigen::Vector3d(i % 10, i / 10 % 10, i / 100));
  }
  for (const auto& points : inputs) {
    GrowingHull hull(points);
    hull.Grow();
    const double expected = MassPropertiesOf(*ConvexHull(points)).volume;
    EXPECT_NEAR(hull.Volume(), expected, 1e-6 * expected);
    const TriMesh mesh = hull.Mesh();
    EXPECT_TRUE(TopologyOf(mesh).ClosedManifold());
    EXPECT_NEAR(MassPropertiesOf(mesh).volume, expected, 1e-6 * expected);
    for (const auto& p : points) EXPECT_LE(DistanceOutside(mesh, p), 1e-6);
  }
}

TEST(SharedVolume, OfBoxes) {
  const TriMesh a = BoxMesh({0, 0, 0}, {2, 2, 2});
  EXPECT_NEAR(SharedVolume(a, BoxMesh({1, 0, 0}, {4, 2, 2})), 4, 1e-9);
  EXPECT_NEAR(SharedVolume(a, BoxMesh({0.5, 0.5, 0.5}, {1, 1, 1})), 0.125, 1e-9);
  EXPECT_EQ(SharedVolume(a, BoxMesh({2, 0, 0}, {4, 2, 2})), 0);
  EXPECT_NEAR(SharedVolume(a, SphereMesh(1, 24)), std::numbers::pi / 6, 0.05);
}

TEST(ConvexHull, OfFlatPointsIsEmptyOrThickened) {
  std::vector<Eigen::Vector3d> square = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0.5, 0.5, 1}};
  EXPECT_FALSE(ConvexHull(square));
  EXPECT_EQ(HullVolume(square), 0);
  const auto thick = ConvexHull(square, {0, 0.1});
  ASSERT_TRUE(thick);
  EXPECT_NEAR(MassPropertiesOf(*thick).volume, 0.1, 1e-12);
  EXPECT_FALSE(ConvexHull({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}, {0, 0.1}));
  EXPECT_FALSE(ConvexHull({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}}));
  EXPECT_FALSE(ConvexHull({}));
}

}  // namespace
}  // namespace dexremoe
