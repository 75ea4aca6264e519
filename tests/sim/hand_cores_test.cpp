// Rounded cores against the colliders that they stand for.
#include "sim/lanes/hand_cores.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "base/random.h"
#include "geometry/hull.h"
#include "geometry/triangle_bvh.h"
#include "scenes.h"
#include "sim/lanes/object_surface.h"

namespace dexremoe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const Pose kSomewhere = {QuaternionFromRpy(0.3, -1.1, 2.0), {0.01, -0.02, 0.03}};

HandModel HandOf(const Collider& collider) {
  HandModel hand = scenes::PalmOnly();
  hand.colliders = {collider};
  return hand;
}

Collider Tilted(ColliderShape shape) {
  Collider collider;
  collider.shape = shape;
  collider.X_LC = kSomewhere;
  collider.fingertip = shape != ColliderShape::kHull;
  return collider;
}

Vector3d RandomPoint(Rng& rng, double size) {
  return Vector3d(rng.Uniform(-size, size), rng.Uniform(-size, size), rng.Uniform(-size, size));
}

double DistanceTo(const std::vector<RoundedCore>& cores, const Vector3d& p_L) {
  double least = INFINITY;
  for (const RoundedCore& core : cores) least = std::min(least, dexremoe::DistanceTo(core, p_L));
  return least;
}

// Points all over the surface of a core; the Fibonacci sphere around the corners of its box and
// around points between them.
std::vector<Vector3d> SurfaceOf(const RoundedCore& core) {
  std::vector<Vector3d> points;
  for (int at = 0; at < 27; ++at) {
    const Vector3d s(at % 3 - 1, at / 3 % 3 - 1, at / 9 - 1);
    const Vector3d start = core.center + core.axes * core.half.cwiseProduct(s);
    for (int i = 0; i < 100; ++i) {
      const double z = 1 - (2 * i + 1) / 100.0, turn = 2.399963229728653 * i;
      const double r = std::sqrt(1 - z * z);
      const Vector3d p = start + core.radius * Vector3d(r * std::cos(turn), r * std::sin(turn), z);
      if (std::abs(dexremoe::DistanceTo(core, p)) < 1e-9) points.push_back(p);
    }
  }
  return points;
}

void ExpectWellFormed(const RoundedCore& core) {
  EXPECT_LT((core.axes.transpose() * core.axes - Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_GT(core.axes.determinant(), 0);
  EXPECT_GE(core.half.x(), core.half.y());
  EXPECT_GE(core.half.y(), core.half.z());
  EXPECT_GE(core.half.z(), 0);
  EXPECT_GT(core.radius, 0);
}

TEST(HandCores, SpheresAndCapsulesAreExact) {
  Rng rng(1, Stream::kTest);
  for (const ColliderShape shape : {ColliderShape::kSphere, ColliderShape::kCapsule}) {
    Collider collider = Tilted(shape);
    collider.radius = 0.009;
    collider.half_length = shape == ColliderShape::kCapsule ? 0.02 : 0;
    const std::vector<RoundedCore> cores = CoresOf(HandOf(collider));
    ASSERT_EQ(cores.size(), 1u);
    ExpectWellFormed(cores[0]);
    EXPECT_EQ((cores[0].half.array() > 0).count(), shape == ColliderShape::kCapsule ? 1 : 0);
    EXPECT_TRUE(cores[0].fingertip);
    for (int i = 0; i < 200; ++i) {
      const Vector3d p = RandomPoint(rng, 0.05);  // in C
      const Vector3d axis(0, 0, std::clamp(p.z(), -collider.half_length, collider.half_length));
      EXPECT_NEAR(DistanceTo(cores, kSomewhere * p), (p - axis).norm() - collider.radius, 1e-12);
    }
  }
}

TEST(HandCores, BoxesHaveExactFacesAndRoundEdges) {
  Collider box = Tilted(ColliderShape::kBox);
  box.half_size = {0.012, 0.03, 0.02};
  const std::vector<RoundedCore> cores = CoresOf(HandOf(box));
  ASSERT_EQ(cores.size(), 1u);
  ExpectWellFormed(cores[0]);
  const double r = 8e-3;
  EXPECT_DOUBLE_EQ(cores[0].radius, r);
  const auto at = [&](double x, double y, double z) {
    return DistanceTo(cores, kSomewhere * box.half_size.cwiseProduct(Vector3d(x, y, z)));
  };
  for (const double side : {-1.0, 1.0}) {
    EXPECT_NEAR(at(side, 0, 0), 0, 1e-12);
    EXPECT_NEAR(at(0, side, 0.5), 0, 1e-12);
    EXPECT_NEAR(at(0.2, 0, side), 0, 1e-12);
    EXPECT_NEAR(at(side, 1, 0), (std::sqrt(2.0) - 1) * r, 1e-12);
    EXPECT_NEAR(at(side, 1, -1), (std::sqrt(3.0) - 1) * r, 1e-12);
  }
}

TEST(HandCores, ThinBoxesBecomePlatesWithoutAThirdExtent) {
  Collider box = Tilted(ColliderShape::kBox);
  box.half_size = {0.003, 0.02, 0.03};
  const std::vector<RoundedCore> cores = CoresOf(HandOf(box));
  ASSERT_EQ(cores.size(), 1u);
  EXPECT_EQ(cores[0].half.z(), 0);
  EXPECT_DOUBLE_EQ(cores[0].radius, 0.003);
  EXPECT_NEAR(std::abs(cores[0].axes.col(0).dot(kSomewhere.q * Vector3d::UnitZ())), 1, 1e-12);
}

TEST(HandCores, AHullThatIsABoxTakesOneCore) {
  Collider collider = Tilted(ColliderShape::kHull);
  collider.hull = scenes::BoxMesh({0.04, 0.03, 0.02});
  CoreOptions options;
  const std::vector<RoundedCore> cores = CoresOf(HandOf(collider), options);
  ASSERT_EQ(cores.size(), 1u);
  ExpectWellFormed(cores[0]);
  EXPECT_DOUBLE_EQ(cores[0].radius, options.cover.radius);
  for (const Vector3d& p : SpreadOverSurface(collider.hull, 500)) {
    const double gap = DistanceTo(cores, kSomewhere * p);
    EXPECT_LT(gap, (std::sqrt(3.0) - 1) * options.cover.radius);
    EXPECT_GT(gap, -1.01 * options.cover.overhang);
  }
}

TriMesh RandomHull(Rng& rng, const Vector3d& size) {
  std::vector<Vector3d> points;
  for (int i = 0; i < 40; ++i)
    points.push_back(
        size.cwiseProduct(Vector3d(rng.Normal(), rng.Normal(), rng.Normal()).normalized()));
  return *ConvexHull(points, {});
}

TEST(HandCores, NeverReachFartherOutOfAHullThanAllowed) {
  Rng rng(2, Stream::kTest);
  for (const Vector3d& size : {Vector3d(0.02, 0.02, 0.02), Vector3d(0.04, 0.012, 0.01),
                               Vector3d(0.03, 0.03, 0.003), Vector3d(0.03, 0.004, 0.002)})
    for (const int extents : {1, 2, 3}) {
      Collider collider = Tilted(ColliderShape::kHull);
      collider.hull = size.x() > 0.035 ? scenes::BoxMesh(size) : RandomHull(rng, size);
      CoreOptions options;
      options.cover.extents = extents;
      const std::vector<RoundedCore> cores = CoresOf(HandOf(collider), options);
      ASSERT_FALSE(cores.empty());
      EXPECT_LE(cores.size(), static_cast<std::size_t>(options.cover.most));
      for (const RoundedCore& core : cores) {
        ExpectWellFormed(core);
        EXPECT_LE((core.half.array() > 0).count(), extents);
        for (const Vector3d& p : SurfaceOf(core))
          EXPECT_LE(DistanceOutside(collider.hull, kSomewhere.Inverse() * p),
                    options.cover.overhang + 1e-9);
      }
    }
}

TEST(HandCores, MoreCoresLeaveSmallerGaps) {
  Rng rng(3, Stream::kTest);
  Collider collider = Tilted(ColliderShape::kHull);
  collider.hull = RandomHull(rng, {0.03, 0.02, 0.008});
  double last = INFINITY;
  for (const int most : {1, 2, 4, 8}) {
    CoreOptions options;
    options.cover.most = most;
    options.cover.gap = 0;
    const std::vector<RoundedCore> cores = CoresOf(HandOf(collider), options);
    double sum = 0;
    for (const Vector3d& p : SpreadOverSurface(collider.hull, 2000))
      sum += std::pow(std::max(0.0, DistanceTo(cores, kSomewhere * p)), 2);
    EXPECT_LT(sum, last);
    last = sum;
  }
  EXPECT_LT(std::sqrt(last / 2000), 1e-3);
}

TEST(HandCores, CoverHullsOfALinkTogether) {
  // The middle hull is hidden within the outer one and takes no core.
  Collider outer = Tilted(ColliderShape::kHull), hidden = outer;
  outer.hull = scenes::BoxMesh({0.05, 0.03, 0.02});
  hidden.hull = scenes::BoxMesh({0.02, 0.01, 0.01});
  HandModel hand = HandOf(hidden);
  hand.colliders.push_back(outer);
  const std::vector<RoundedCore> cores = CoresOf(hand);
  ASSERT_EQ(cores.size(), 1u);
  EXPECT_EQ(cores[0].collider, 1);
  // A fingertip is covered apart from the rest of its link.
  hand.colliders[0].fingertip = true;
  const std::vector<RoundedCore> apart = CoresOf(hand);
  ASSERT_GE(apart.size(), 2u);
  EXPECT_FALSE(apart[0].fingertip);
  EXPECT_TRUE(apart[1].fingertip);
  EXPECT_EQ(apart[1].half.y(), 0);  // by capsules
}

TEST(HandCores, OfTheProjectsHandAreItsColliders) {
  const HandOptions options;
  if (!std::filesystem::exists(options.urdf)) GTEST_SKIP() << "not run from the project's folder";
  const HandModel hand = LoadHand(options);
  const std::vector<RoundedCore> cores = CoresOf(hand);
  ASSERT_EQ(cores.size(), hand.colliders.size());
  std::vector<int> seen;
  for (const RoundedCore& core : cores) {
    ExpectWellFormed(core);
    EXPECT_EQ(core.link, hand.colliders[core.collider].link);
    EXPECT_EQ(core.fingertip, hand.colliders[core.collider].fingertip);
    seen.push_back(core.collider);
  }
  std::sort(seen.begin(), seen.end());
  EXPECT_EQ(std::unique(seen.begin(), seen.end()), seen.end());
}

// Hulls of a link, fingertips or not, with their cores.
struct Covered {
  ConvexParts hulls;
  std::vector<RoundedCore> cores;
};

Covered CoverOf(const HandModel& hand, const std::vector<RoundedCore>& cores, int link, bool tip) {
  Covered covered;
  for (const Collider& collider : hand.colliders)
    if (collider.link == link && collider.fingertip == tip &&
        collider.shape == ColliderShape::kHull) {
      covered.hulls.push_back(collider.hull);
      for (Vector3d& p : covered.hulls.back().vertices) p = collider.X_LC * p;
    }
  for (const RoundedCore& core : cores)
    if (core.link == link && core.fingertip == tip) covered.cores.push_back(core);
  return covered;
}

struct Spread {
  double p50, p95, max;  // mm
};
Spread SpreadOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](double q) {
    return 1e3 * values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
  };
  return {at(0.5), at(0.95), at(1)};
}

TEST(HandCores, StayCloseToTheRealHand) {
  HandOptions options;
  const char* urdf = std::getenv("DEX_REAL_HAND");
  if (urdf == nullptr) GTEST_SKIP() << "DEX_REAL_HAND is not set";
  options.urdf = urdf;
  const HandModel hand = LoadHand(options);
  const std::vector<RoundedCore> cores = CoresOf(hand);
  std::printf("%zu colliders, %zu cores; gap and overhang in mm\n", hand.colliders.size(),
              cores.size());
  EXPECT_LE(cores.size(), 60u);
  for (int link = 0; link < static_cast<int>(hand.links.size()); ++link)
    for (const bool tip : {false, true}) {
      const Covered covered = CoverOf(hand, cores, link, tip);
      if (covered.hulls.empty()) continue;
      std::vector<double> gap, overhang;
      for (const Vector3d& p : SpreadOverSurface(UnionSurface(covered.hulls), 2000))
        gap.push_back(std::max(0.0, DistanceTo(covered.cores, p)));
      UnionDistance distance(covered.hulls);
      for (const RoundedCore& core : covered.cores)
        for (const Vector3d& p : SurfaceOf(core))
          overhang.push_back(std::max(0.0, distance.Signed(p)));
      const Spread g = SpreadOf(gap), o = SpreadOf(overhang);
      std::printf("%-10s %-4s %zu hulls %zu cores  gap p50 %.2f p95 %.2f max %.2f  ",
                  hand.links[link].name.c_str(), tip ? "tip" : "", covered.hulls.size(),
                  covered.cores.size(), g.p50, g.p95, g.max);
      std::printf("overhang p95 %.2f max %.2f\n", o.p95, o.max);
      EXPECT_LT(g.p50, tip ? 1.5 : 1);
      EXPECT_LT(g.p95, link == 0 ? 8 : tip ? 4 : 3);  // the base is a hollow shell of 98 x 83 mm
      EXPECT_LT(o.max, 1);
    }
}

}  // namespace
}  // namespace dexremoe
