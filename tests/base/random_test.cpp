#include "base/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace dexremoe {
namespace {

constexpr int kDraws = 200000;

TEST(Rng, UniformHasTheMomentsOfTheUnitInterval) {
  Rng rng(1, Stream::kTest);
  double sum = 0, squares = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double u = rng.Uniform();
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    sum += u;
    squares += u * u;
  }
  const double mean = sum / kDraws;
  EXPECT_NEAR(mean, 0.5, 5 / std::sqrt(12.0 * kDraws));
  EXPECT_NEAR(squares / kDraws - mean * mean, 1.0 / 12, 1e-3);
}

TEST(Rng, NormalHasTheMomentsAndTailsOfTheStandardNormal) {
  Rng rng(2, Stream::kTest);
  double m1 = 0, m2 = 0, m4 = 0;
  int tail = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double z = rng.Normal();
    ASSERT_TRUE(std::isfinite(z));
    m1 += z;
    m2 += z * z;
    m4 += z * z * z * z;
    tail += std::abs(z) > 1.959964;
  }
  EXPECT_NEAR(m1 / kDraws, 0, 5 / std::sqrt(double{kDraws}));
  EXPECT_NEAR(m2 / kDraws, 1, 0.02);
  EXPECT_NEAR(m4 / kDraws, 3, 0.12);
  EXPECT_NEAR(static_cast<double>(tail) / kDraws, 0.05, 0.003);
}

TEST(Rng, IndexFillsItsCellsEvenly) {
  Rng rng(3, Stream::kTest);
  std::vector<int> count(7, 0);
  for (int i = 0; i < kDraws; ++i) ++count.at(rng.Index(7));
  const double expected = kDraws / 7.0;
  double chi2 = 0;
  for (const int c : count) chi2 += (c - expected) * (c - expected) / expected;
  EXPECT_LT(chi2, 22.5);  // 6 degrees of freedom, p = 0.001
  EXPECT_EQ(rng.Index(1), 0u);
}

// Under the Haar measure the rotation angle has density (1 - cos a) / pi, with mean pi/2 + 2/pi,
// and every direction is as likely as any other.
TEST(Rng, QuaternionsAreHaarUniform) {
  Rng rng(4, Stream::kTest);
  double angle = 0, outer[4] = {0, 0, 0, 0};
  for (int i = 0; i < kDraws; ++i) {
    const auto q = rng.UnitQuaternion();
    ASSERT_GE(q[0], 0);
    double norm = 0;
    for (int k = 0; k < 4; ++k) {
      norm += q[k] * q[k];
      outer[k] += q[k] * q[k];
    }
    ASSERT_NEAR(norm, 1, 1e-12);
    angle += 2 * std::acos(std::min(1.0, q[0]));
  }
  EXPECT_NEAR(angle / kDraws, M_PI / 2 + 2 / M_PI, 0.01);
  for (const double o : outer) EXPECT_NEAR(o / kDraws, 0.25, 0.003);
}

TEST(Rng, StreamsOfNeighbouringIndicesSeedsAndPurposesAreUncorrelated) {
  const auto correlation = [](Rng a, Rng b) {
    const int n = 20000;
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += (a.Uniform() - 0.5) * (b.Uniform() - 0.5);
    return 12 * sum / n;
  };
  const double bound = 5 / std::sqrt(20000.0);
  for (std::uint64_t i = 0; i < 8; ++i) {
    EXPECT_LT(std::abs(correlation({1, Stream::kTest, {i}}, {1, Stream::kTest, {i + 1}})), bound);
    EXPECT_LT(std::abs(correlation({i, Stream::kTest}, {i + 1, Stream::kTest})), bound);
    EXPECT_LT(std::abs(correlation({1, Stream::kTest, {i}}, {1, Stream::kReset, {i}})), bound);
  }
}

TEST(SeedOf, AddressesDoNotCollide) {
  std::set<std::uint64_t> seen;
  std::size_t count = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed)
    for (const Stream stream : {Stream::kTest, Stream::kReset, Stream::kGoal})
      for (std::uint64_t i = 0; i < 30; ++i) {
        seen.insert(SeedOf(seed, stream, {i}));
        ++count;
        for (std::uint64_t j = 0; j < 30; ++j) {
          seen.insert(SeedOf(seed, stream, {i, j}));
          ++count;
        }
      }
  EXPECT_EQ(seen.size(), count);
  // The order and the number of indices matter.
  EXPECT_NE(SeedOf(1, Stream::kTest, {1, 2}), SeedOf(1, Stream::kTest, {2, 1}));
  EXPECT_NE(SeedOf(1, Stream::kTest, {1}), SeedOf(1, Stream::kTest, {1, 0}));
  EXPECT_NE(SeedOf(1, Stream::kTest), SeedOf(1, Stream::kTest, {0}));
}

TEST(Rng, FirstDrawsOverAStreamOfIndicesAreUniformToo) {
  // One draw per address, as episode resets use them.
  double sum = 0, lag = 0, last = 0.5;
  for (int i = 0; i < kDraws; ++i) {
    const double u = Rng(9, Stream::kReset, {static_cast<std::uint64_t>(i)}).Uniform();
    sum += u;
    lag += (u - 0.5) * (last - 0.5);
    last = u;
  }
  EXPECT_NEAR(sum / kDraws, 0.5, 5 / std::sqrt(12.0 * kDraws));
  EXPECT_LT(std::abs(12 * lag / kDraws), 5 / std::sqrt(double{kDraws}));
}

TEST(Rng, TheStateContinuesTheStream) {
  Rng a(5, Stream::kTest);
  for (int i = 0; i < 10; ++i) a.Normal();
  Rng b(a.state());
  for (int i = 0; i < 10; ++i) EXPECT_EQ(a.Next(), b.Next());
}

}  // namespace
}  // namespace dexremoe
