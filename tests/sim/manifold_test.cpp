// Contact geometry against closed forms and a brute-force referee.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "scenes.h"
#include "sim/ode/contacts.h"

namespace dexremoe {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kMargin = 2e-3;

const ConvexShape& UnitBox() {  // half sizes 30, 20, 10 mm
  static const ConvexShape shape = ShapeOfHull(scenes::BoxMesh({0.06, 0.04, 0.02}), "box");
  return shape;
}

PlacedShape AtOrigin(const ConvexShape& shape) {
  PlacedShape placed;
  placed.shape = &shape;
  placed.identity = true;
  return placed;
}

PlacedShape At(const ConvexShape& shape, const Vector3d& p, const Quaterniond& q) {
  PlacedShape placed;
  placed.shape = &shape;
  placed.R = q.toRotationMatrix();
  placed.p = p;
  return placed;
}

ConvexShape Sphere(double radius) {
  Collider collider;
  collider.radius = radius;
  return ShapeOfCollider(collider);
}

ConvexShape Capsule(double radius, double half_length) {
  Collider collider;
  collider.shape = ColliderShape::kCapsule;
  collider.radius = radius;
  collider.half_length = half_length;
  return ShapeOfCollider(collider);
}

TEST(Convex, ABoxHasSixFacesAndTwelveEdges) {
  EXPECT_EQ(UnitBox().faces.size(), 6u);
  EXPECT_EQ(UnitBox().edges.size(), 12u);
  for (const ConvexFace& face : UnitBox().faces) EXPECT_EQ(face.loop.size(), 4u);
}

TEST(Convex, AnOpenMeshIsRefusedByName) {
  TriMesh mesh = scenes::BoxMesh({1, 1, 1});
  mesh.triangles.pop_back();
  try {
    ShapeOfHull(mesh, "object duck: part 3");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("object duck: part 3"), std::string::npos);
  }
}

TEST(Manifold, ASphereOnAFaceTouchesInOnePointAlongTheNormal) {
  const ConvexShape sphere = Sphere(0.01);
  for (const double gap : {-4e-3, -1e-5, 1e-3}) {
    const Manifold m =
        FindManifold(AtOrigin(UnitBox()),
                     At(sphere, {0.007, -0.003, -0.02 - gap}, Quaterniond::Identity()), kMargin);
    ASSERT_EQ(m.size, 1);
    EXPECT_NEAR(m.point[0].gap, gap, 1e-9);
    EXPECT_LT((m.normal - Vector3d::UnitZ()).norm(), 1e-9);  // from the sphere to the box
    EXPECT_LT((m.point[0].position - Vector3d(0.007, -0.003, -0.01 - gap / 2)).norm(), 1e-9);
  }
}

TEST(Manifold, ASphereAtAnEdgeTouchesAlongTheLineOfNearestPoints) {
  const Vector3d toward = Vector3d(0, -1, -2).normalized();
  const Manifold m = FindManifold(
      AtOrigin(UnitBox()),
      At(Sphere(0.01), Vector3d(0.01, -0.02, -0.01) + 0.0105 * toward, Quaterniond::Identity()),
      kMargin);
  ASSERT_EQ(m.size, 1);
  EXPECT_NEAR(m.point[0].gap, 5e-4, 1e-9);
  EXPECT_LT((m.normal + toward).norm(), 1e-9);
}

TEST(Manifold, ACapsuleLyingOnAFaceTouchesInTwoPoints) {
  const ConvexShape capsule = Capsule(0.009, 0.015);
  const Quaterniond lying(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitY()));
  const Manifold m =
      FindManifold(AtOrigin(UnitBox()), At(capsule, {0.005, 0, 0.0188}, lying), kMargin);
  ASSERT_EQ(m.size, 2);
  EXPECT_LT((m.normal + Vector3d::UnitZ()).norm(), 1e-9);
  EXPECT_NEAR(std::abs(m.point[0].position.x() - m.point[1].position.x()), 0.03, 1e-9);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(m.point[i].gap, -2e-4, 1e-9);
}

TEST(Manifold, ACapsuleOverTheRimIsClippedToTheFace) {
  const Quaterniond lying(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitY()));
  const Manifold m = FindManifold(AtOrigin(UnitBox()),
                                  At(Capsule(0.009, 0.015), {0.03, 0, 0.0188}, lying), kMargin);
  ASSERT_EQ(m.size, 2);
  for (int i = 0; i < 2; ++i) EXPECT_LE(m.point[i].position.x(), 0.03 + 1e-9);
}

TEST(Manifold, ABoxOnABoxTouchesInFourPointsOfTheOverlap) {
  for (const double gap : {-3e-3, -1e-4, 5e-4}) {
    const Quaterniond turned(Eigen::AngleAxisd(0.3, Vector3d::UnitZ()));
    const Manifold m = FindManifold(AtOrigin(UnitBox()),
                                    At(UnitBox(), {0.02, 0.01, -0.02 - gap}, turned), kMargin);
    ASSERT_EQ(m.size, 4) << gap;
    EXPECT_LT((m.normal - Vector3d::UnitZ()).norm(), 1e-9);
    for (int i = 0; i < 4; ++i) {
      EXPECT_NEAR(m.point[i].gap, gap, 1e-9);
      EXPECT_LE(std::abs(m.point[i].position.x()), 0.03 + 1e-9);
      EXPECT_LE(std::abs(m.point[i].position.y()), 0.02 + 1e-9);
    }
  }
}

TEST(Manifold, ScaleStretchesTheShapeAboutItsOrigin) {
  PlacedShape box = AtOrigin(UnitBox());
  box.scale = 1.5;
  const Manifold m =
      FindManifold(box, At(Sphere(0.01), {0, 0, 0.0255}, Quaterniond::Identity()), kMargin);
  ASSERT_EQ(m.size, 1);
  EXPECT_NEAR(m.point[0].gap, 5e-4, 1e-9);
}

double DistanceToBox(const Vector3d& p) {
  const Vector3d outside = (p.cwiseAbs() - Vector3d(0.03, 0.02, 0.01)).cwiseMax(0);
  return outside.norm();
}

// The distance of a capsule's axis to the box is convex along the axis: golden-section referee.
double AxisDistance(const PlacedShape& capsule) {
  double low = 0, high = 1;
  const Vector3d from = capsule.Vertex(0), along = capsule.Vertex(1) - from;
  for (int i = 0; i < 80; ++i) {
    const double a = low + 0.382 * (high - low), b = low + 0.618 * (high - low);
    (DistanceToBox(from + a * along) < DistanceToBox(from + b * along) ? high : low) =
        DistanceToBox(from + a * along) < DistanceToBox(from + b * along) ? b : a;
  }
  return DistanceToBox(from + low * along);
}

TEST(Proximity, RandomCapsulesAgreeWithAGoldenSectionReferee) {
  const ConvexShape capsule = Capsule(0.009, 0.02);
  int apart = 0;
  for (std::uint64_t i = 0; i < 3000; ++i) {
    Rng rng(1, Stream::kTest, {i});
    const auto q = rng.UnitQuaternion();
    const Vector3d p(rng.Uniform(-0.06, 0.06), rng.Uniform(-0.05, 0.05), rng.Uniform(-0.04, 0.04));
    const PlacedShape placed = At(capsule, p, Quaterniond(q[0], q[1], q[2], q[3]));
    const double expected = AxisDistance(placed);
    const Proximity found = FindProximity(AtOrigin(UnitBox()), placed, 1);
    ASSERT_TRUE(found.near);
    if (expected < 1e-7) {
      EXPECT_LE(found.distance, 1e-7) << i;
      continue;
    }
    ++apart;
    EXPECT_NEAR(found.distance, expected, 1e-7) << i;
    EXPECT_NEAR((found.on_a - found.on_b - found.distance * found.normal).norm(), 0, 1e-7);
  }
  EXPECT_GT(apart, 1000);
}

// Moving a box out along the reported normal by the reported depth must free it.
TEST(Proximity, MovingOutByTheReportedDepthFreesTheBox) {
  int overlapping = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Rng rng(2, Stream::kTest, {i});
    const auto q = rng.UnitQuaternion();
    const Quaterniond rotation(q[0], q[1], q[2], q[3]);
    const Vector3d p(rng.Uniform(-0.05, 0.05), rng.Uniform(-0.04, 0.04), rng.Uniform(-0.03, 0.03));
    const PlacedShape a = AtOrigin(UnitBox()), b = At(UnitBox(), p, rotation);
    const Proximity found = FindProximity(a, b, 1);
    ASSERT_TRUE(found.near);
    if (found.distance >= 0) continue;
    ++overlapping;
    PlacedShape freed = b;
    freed.p -= (-found.distance + 1e-6) * found.normal;
    EXPECT_GE(FindProximity(a, freed, 1).distance, 0) << i;
  }
  EXPECT_GT(overlapping, 200);
}

}  // namespace
}  // namespace dexremoe
