// The lanes engine's distance field against closed forms for unions of boxes.
#include "sim/lanes/object_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "geometry/pose.h"
#include "scenes.h"
#include "sim/lanes/object_surface.h"

namespace dexremoe {
namespace {

using Eigen::Vector3d;

constexpr double kMargin = 0.02;  // m

// A union of boxes with closed forms for its distance.
struct Boxes {
  struct Box {
    Pose X_OB;
    Vector3d size;
  };
  const char* name;
  std::vector<Box> boxes;

  ConvexParts Parts() const {
    ConvexParts parts;
    for (const Box& box : boxes) {
      parts.push_back(scenes::BoxMesh(box.size));
      for (Vector3d& p : parts.back().vertices) p = box.X_OB * p;
    }
    return parts;
  }
  // Outside exact; inside the plain minimum over the boxes, of which only the sign counts.
  double Distance(const Vector3d& p) const {
    double least = INFINITY;
    for (const Box& box : boxes) {
      const Vector3d q = (box.X_OB.Inverse() * p).cwiseAbs() - box.size / 2;
      least = std::min(least, q.cwiseMax(0.0).norm() + std::min(0.0, q.maxCoeff()));
    }
    return least;
  }
};

Boxes::Box At(const Vector3d& center, const Vector3d& size) { return {{.p = center}, size}; }

Boxes Cube() { return {"cube", {At({0, 0, 0}, {0.055, 0.055, 0.055})}}; }

Boxes Ell() {
  return {"L", {At({0, 0, 0}, {0.08, 0.02, 0.02}), At({-0.03, 0.03, 0}, {0.02, 0.04, 0.02})}};
}

Boxes Airplane() {
  return {"airplane",
          {At({0, 0, 0}, {0.1, 0.012, 0.012}), At({0.01, 0, 0}, {0.02, 0.096, 0.004}),
           At({-0.044, 0, 0.002}, {0.012, 0.036, 0.003}),
           At({-0.044, 0, 0.014}, {0.012, 0.003, 0.024})}};
}

Boxes Tilted() {
  const Eigen::Quaterniond q = QuaternionFromRpy(0.4, -0.7, 1.1);
  return {"tilted cross",
          {{{q, {0.004, 0, 0}}, {0.07, 0.018, 0.022}}, {{q, {0, 0.003, 0}}, {0.02, 0.064, 0.016}}}};
}

std::vector<Boxes> Shapes() { return {Cube(), Ell(), Airplane(), Tilted()}; }

Vector3d RandomIn(Rng& rng, const Box3& box, double around) {
  Vector3d p;
  for (int k = 0; k < 3; ++k) p[k] = rng.Uniform(box.min[k] - around, box.max[k] + around);
  return p;
}

Box3 BoundsOf(const ConvexParts& parts) {
  Box3 box;
  for (const TriMesh& part : parts)
    for (const Vector3d& p : part.vertices) box.Extend(p);
  return box;
}

double CountsAt(const ObjectField& field, int x, int y, int z) {
  return field.nodes[FieldIndex(x, y, z)];
}

// Values at all nodes; m.
std::vector<double> NodeValues(const ObjectField& field) {
  std::vector<double> values;
  for (int x = 0; x < kFieldNodes; ++x)
    for (int y = 0; y < kFieldNodes; ++y)
      for (int z = 0; z < kFieldNodes; ++z)
        values.push_back(field.quantum * CountsAt(field, x, y, z));
  return values;
}

double LargestDifference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

struct Spread {
  double p1, p50, p99, max;
};
Spread SpreadOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](double q) {
    return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
  };
  return {at(0.01), at(0.5), at(0.99), values.back()};
}

TEST(ObjectField, IsAccurateInTheShellWhereHandsTouch) {
  for (const Boxes& shape : Shapes()) {
    const ConvexParts parts = shape.Parts();
    const auto start = std::chrono::steady_clock::now();
    const ObjectField field = BuildObjectField(parts, kMargin);
    const std::chrono::duration<double, std::milli> build =
        std::chrono::steady_clock::now() - start;
    Rng rng(1, Stream::kTest);
    std::vector<double> near, far;  // 3 .. 8 mm and 8 .. 14 mm outside
    double sum = 0;
    while (near.size() < 5000 || far.size() < 5000) {
      const Vector3d p = RandomIn(rng, BoundsOf(parts), 0.014);
      const double exact = shape.Distance(p);
      if (exact < 0.003 || exact > 0.014) continue;
      const double error = SampleField(field, p).distance - exact;
      (exact < 0.008 ? near : far).push_back(std::abs(error));
      sum += error;
    }
    const double mean = sum / static_cast<double>(near.size() + far.size());
    const Spread close = SpreadOf(near), wide = SpreadOf(far);
    std::printf("%-12s %5.1f ms  mean %+.3f mm; p50 p99 max: %.3f %.3f %.3f mm at 3-8 mm, ",
                shape.name, build.count(), 1e3 * mean, 1e3 * close.p50, 1e3 * close.p99,
                1e3 * close.max);
    std::printf("%.3f %.3f %.3f mm at 8-14 mm\n", 1e3 * wide.p50, 1e3 * wide.p99, 1e3 * wide.max);
    EXPECT_LT(std::abs(mean), 0.02e-3) << shape.name;
    EXPECT_LT(std::max(close.p50, wide.p50), 0.08e-3) << shape.name;
    EXPECT_LT(std::max(close.p99, wide.p99), 0.7e-3) << shape.name;
    EXPECT_LT(std::max(close.max, wide.max), 1.5e-3) << shape.name;
  }
}

TEST(ObjectField, IsExactOverAFlatFace) {
  const ObjectField field = BuildObjectField(Cube().Parts(), kMargin);
  Rng rng(2, Stream::kTest);
  for (int i = 0; i < 1000; ++i) {
    // Nodes whose neighbours all look at the face.
    const double height = rng.Uniform(0.0035, 0.019);
    const Vector3d p(0.0275 + height, rng.Uniform(-0.02, 0.02), rng.Uniform(-0.02, 0.02));
    const FieldSample sample = SampleField(field, p);
    EXPECT_NEAR(sample.distance, height, 2e-6);
    EXPECT_LT((sample.gradient - Vector3d::UnitX()).norm(), 3e-3);
  }
}

TEST(ObjectField, HasTheRightSign) {
  for (const Boxes& shape : Shapes()) {
    const ObjectField field = BuildObjectField(shape.Parts(), kMargin);
    Rng rng(3, Stream::kTest);
    for (int i = 0; i < 20000; ++i) {
      const Vector3d p = RandomIn(rng, BoundsOf(shape.Parts()), kMargin);
      const double exact = shape.Distance(p);
      if (std::abs(exact) > 1.5e-3) {
        ASSERT_EQ(SampleField(field, p).distance > 0, exact > 0)
            << shape.name << " at " << p.transpose();
      }
    }
  }
}

TEST(ObjectField, CannotTellACutSolidFromAWholeOne) {
  const std::vector<double> whole =
      NodeValues(BuildObjectField({scenes::BoxMesh({0.08, 0.04, 0.03})}, kMargin));
  const auto cut = [](double gap) {
    const double length = 0.04 - gap / 2;
    return ConvexParts{scenes::BoxMesh({length, 0.04, 0.03}, {-0.02 - gap / 4, 0, 0}),
                       scenes::BoxMesh({length, 0.04, 0.03}, {0.02 + gap / 4, 0, 0})};
  };
  EXPECT_LT(LargestDifference(whole, NodeValues(BuildObjectField(cut(0), kMargin))), 3e-6);
  EXPECT_LT(LargestDifference(whole, NodeValues(BuildObjectField(cut(-0.02), kMargin))), 3e-6);
  // A gap narrower than kSeam is closed, up to how far its mouth reaches in.
  EXPECT_LT(LargestDifference(whole, NodeValues(BuildObjectField(cut(0.4e-3), kMargin))), kSeam);
  // A part within another changes nothing.
  EXPECT_LT(LargestDifference(whole, NodeValues(BuildObjectField(
                                         {scenes::BoxMesh({0.08, 0.04, 0.03}),
                                          scenes::BoxMesh({0.02, 0.02, 0.02}, {0.01, 0.002, 0})},
                                         kMargin))),
            3e-6);
}

TEST(ObjectField, LeadsOutOfEveryDepth) {
  for (const Boxes& shape : Shapes()) {
    const ObjectField field = BuildObjectField(shape.Parts(), kMargin);
    Rng rng(4, Stream::kTest);
    int inside = 0;
    for (int i = 0; i < 20000 && inside < 500; ++i) {
      Vector3d p = RandomIn(rng, BoundsOf(shape.Parts()), 0);
      FieldSample sample = SampleField(field, p);
      // Half way between two sides the slope may vanish: there no way out is the nearest.
      if (sample.distance > -1e-3 || sample.gradient.norm() < 0.5) continue;
      ++inside;
      // A walk of half-millimetre steps up the field leaves by the shortest way or nearly so.
      const double depth = -sample.distance;
      double walked = 0;
      while (sample.distance < 0 && walked < 0.05) {
        p += 0.5e-3 * sample.gradient.normalized();
        walked += 0.5e-3;
        sample = SampleField(field, p);
      }
      EXPECT_LT(walked, 1.6 * depth + 3e-3) << shape.name << " from depth " << depth;
    }
    EXPECT_GT(inside, 100) << shape.name;
  }
}

TEST(ObjectField, HasItsOwnGradientInsideAndOutsideTheGrid) {
  const ObjectField field = BuildObjectField(Airplane().Parts(), kMargin);
  Rng rng(5, Stream::kTest);
  const double h = 1e-8;
  int checked = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vector3d p = RandomIn(rng, BoundsOf(Airplane().Parts()), 2 * kMargin);
    const Vector3d cell =
        (p - field.origin.cast<double>()).cwiseQuotient(field.spacing.cast<double>());
    // Away from the borders between cells, where the gradient jumps.
    if (((cell.array() - cell.array().round()).abs() < 1e-3).any()) continue;
    Vector3d expected;
    for (int k = 0; k < 3; ++k)
      expected[k] = (SampleField(field, p + h * Vector3d::Unit(k)).distance -
                     SampleField(field, p - h * Vector3d::Unit(k)).distance) /
                    (2 * h);
    ASSERT_LT((SampleField(field, p).gradient - expected).norm(), 1e-5);
    ++checked;
  }
  EXPECT_GT(checked, 2000);
}

TEST(ObjectField, HasUnitGradientsThatPointAwayFromAConvexObject) {
  const ObjectField field = BuildObjectField(Cube().Parts(), kMargin);
  Rng rng(6, Stream::kTest);
  std::vector<double> lengths, angles;
  while (lengths.size() < 10000) {
    const Vector3d p = RandomIn(rng, BoundsOf(Cube().Parts()), 0.014);
    const double exact = Cube().Distance(p);
    if (exact < 0.003 || exact > 0.014) continue;
    const Vector3d away = (p - p.cwiseMax(-0.0275).cwiseMin(0.0275)).normalized();
    const Vector3d gradient = SampleField(field, p).gradient;
    lengths.push_back(gradient.norm());
    angles.push_back(std::acos(std::min(1.0, gradient.normalized().dot(away))) * 180 / M_PI);
  }
  const Spread length = SpreadOf(lengths), angle = SpreadOf(angles);
  std::printf("cube: length p1 %.3f p99 %.3f, angle off p50 %.2f p99 %.2f max %.2f degrees\n",
              length.p1, length.p99, angle.p50, angle.p99, angle.max);
  EXPECT_GT(length.p1, 0.88);
  EXPECT_LT(length.p99, 1.12);
  EXPECT_LT(angle.p50, 1);
  EXPECT_LT(angle.p99, 15);
}

TEST(ObjectField, MovesWithTheObjectAndDoesNotDependOnTheOrderOfParts) {
  ConvexParts parts = Airplane().Parts();
  const ObjectField field = BuildObjectField(parts, kMargin);
  EXPECT_EQ(BuildObjectField(parts, kMargin).nodes, field.nodes);  // deterministic
  std::reverse(parts.begin(), parts.end());
  const ObjectField reversed = BuildObjectField(parts, kMargin);
  EXPECT_LE(LargestDifference(NodeValues(reversed), NodeValues(field)), 1.01 * field.quantum);
  const Vector3d shift(0.013, -0.027, 0.0041);
  for (TriMesh& part : parts)
    for (Vector3d& p : part.vertices) p += shift;
  const ObjectField moved = BuildObjectField(parts, kMargin);
  EXPECT_LT((moved.origin - field.origin - shift.cast<float>()).norm(), 1e-8);
  EXPECT_LE(LargestDifference(NodeValues(moved), NodeValues(field)), 1.01 * field.quantum);
}

TEST(ObjectField, IsFinelyQuantised) {
  const ObjectField field = BuildObjectField(Ell().Parts(), kMargin);
  ASSERT_EQ(field.nodes.size(), static_cast<std::size_t>(kFieldSize));
  EXPECT_LE(field.quantum, 2.5e-6);
}

TEST(ObjectField, RejectsPartsThatAreNotConvexBodies) {
  TriMesh inside_out = scenes::BoxMesh({0.02, 0.02, 0.02});
  for (auto& triangle : inside_out.triangles) std::swap(triangle[0], triangle[1]);
  EXPECT_THROW(BuildObjectField({inside_out}, kMargin), Error);
  EXPECT_THROW(BuildObjectField({scenes::BoxMesh({0.02, 0.02, 0})}, kMargin), Error);
}

}  // namespace
}  // namespace dexremoe
