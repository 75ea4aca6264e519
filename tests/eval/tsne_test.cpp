#include "eval/tsne.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "eval/neighbours.h"

namespace dexremoe {
namespace {

// `clusters` Gaussian balls of unit width, centres `apart` from each other along the axes.
std::vector<double> Clusters(int clusters, int each, int d, double apart, std::uint64_t seed) {
  Rng rng(seed, Stream::kTest);
  std::vector<double> x;
  for (int i = 0; i < clusters * each; ++i)
    for (int k = 0; k < d; ++k) x.push_back(rng.Normal() + (k == i / each ? apart : 0));
  return x;
}

TEST(Tsne, AffinitiesAreSymmetricAndSumToOneAtAnyScale) {
  const int n = 60, d = 3;
  std::vector<double> x = Clusters(3, n / 3, d, 8, 1);
  for (double& value : x) value *= 1e-5;  // the width adapts to the scale of the data
  ThreadPool pool(2);
  const double perplexity = 12;
  const std::vector<float> p = Affinities(x, n, d, perplexity, pool);
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    EXPECT_EQ(p[i * n + i], 0);
    for (int j = 0; j < n; ++j) {
      EXPECT_EQ(p[i * n + j], p[j * n + i]);
      sum += p[i * n + j];
    }
  }
  EXPECT_NEAR(sum, 1, 1e-5);
  // Equidistant points know their answer: all off-diagonal affinities equal.
  const std::vector<double> corners = {0, 0, 1, 0, 0.5, std::sqrt(0.75)};
  for (const float value : Affinities(corners, 3, 2, 2, pool))
    EXPECT_TRUE(value == 0 || std::abs(value - 1.0 / 6) < 1e-6);
}

// The symmetric matrix hides single rows. On a regular polygon all rows are alike, so the
// conditional affinities are n p_ij.
TEST(Tsne, PerplexityIsReachedOnARegularPolygon) {
  const int n = 24;
  std::vector<double> x;
  for (int i = 0; i < n; ++i) {
    x.push_back(std::cos(2 * M_PI * i / n));
    x.push_back(std::sin(2 * M_PI * i / n));
  }
  ThreadPool pool(1);
  for (const double perplexity : {2.5, 5.0, 15.0}) {
    const std::vector<float> p = Affinities(x, n, 2, perplexity, pool);
    double entropy = 0;
    for (int j = 1; j < n; ++j) {
      const double conditional = n * static_cast<double>(p[j]);
      if (conditional > 0) entropy -= conditional * std::log(conditional);
    }
    EXPECT_NEAR(std::exp(entropy), perplexity, 1e-3 * perplexity);
  }
}

TEST(Tsne, GradientIsTheSlopeOfTheDivergence) {
  const int n = 40, d = 4;
  const std::vector<double> x = Clusters(4, n / 4, d, 3, 2);
  ThreadPool pool(2);
  const std::vector<float> p = Affinities(x, n, d, 8, pool);
  Rng rng(3, Stream::kTest);
  std::vector<double> y(2 * n), gradient;
  for (double& value : y) value = 2 * rng.Normal();
  TsneGradient(p, y, n, 1, gradient, pool);
  double size = 0;
  for (const double g : gradient) size = std::max(size, std::abs(g));
  ASSERT_GT(size, 1e-4);
  for (int k = 0; k < 2 * n; ++k) {
    std::vector<double> up = y, down = y;
    const double h = 1e-5;
    up[k] += h;
    down[k] -= h;
    const double slope =
        (TsneDivergence(p, up, n, pool) - TsneDivergence(p, down, n, pool)) / (2 * h);
    EXPECT_NEAR(gradient[k], slope, 2e-5 * size) << "coordinate " << k;
  }
}

TEST(Tsne, GradientOfExaggeratedAffinitiesIsLinearInTheFactor) {
  const int n = 20;
  const std::vector<double> x = Clusters(2, n / 2, 2, 3, 4);
  ThreadPool pool(1);
  const std::vector<float> p = Affinities(x, n, 2, 5, pool);
  std::vector<double> g1, g2, g3;
  TsneGradient(p, x, n, 1, g1, pool);
  TsneGradient(p, x, n, 2, g2, pool);
  TsneGradient(p, x, n, 3, g3, pool);
  for (int k = 0; k < 2 * n; ++k) EXPECT_NEAR(g2[k] - g1[k], g3[k] - g2[k], 1e-12);
}

TEST(Tsne, SeparateClustersStaySeparate) {
  const int clusters = 4, each = 40, n = clusters * each, d = 4;
  const std::vector<double> x = Clusters(clusters, each, d, 20, 5);
  ThreadPool pool(2);
  const TsneResult result = Tsne(x, n, d, {}, 7, pool);
  EXPECT_EQ(result.distinct, n);
  // Every point's nearest neighbours in the plane belong to its own cluster.
  int foreign = 0;
  for (int i = 0; i < n; ++i) {
    int best = -1;
    double nearest = HUGE_VAL;
    for (int j = 0; j < n; ++j) {
      const double distance = std::hypot(result.position[2 * i] - result.position[2 * j],
                                         result.position[2 * i + 1] - result.position[2 * j + 1]);
      if (j != i && distance < nearest) {
        nearest = distance;
        best = j;
      }
    }
    foreign += best / each != i / each;
  }
  EXPECT_EQ(foreign, 0);
  const NeighbourPreservation kept = ComparePositions(x, n, d, result.position, 2, 10, pool);
  EXPECT_GT(kept.overlap, 0.4);
  EXPECT_GT(kept.trustworthiness, 0.95);
}

TEST(Tsne, ResultIsTheSameForEveryNumberOfWorkersAndRun) {
  const int n = 90, d = 3;
  const std::vector<double> x = Clusters(3, n / 3, d, 6, 6);
  TsneOptions options;
  options.iterations = 300;
  ThreadPool one(1), three(3);
  const TsneResult a = Tsne(x, n, d, options, 7, one);
  const TsneResult b = Tsne(x, n, d, options, 7, three);
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.kl, b.kl);
}

TEST(Tsne, EqualRowsShareAPosition) {
  const int n = 80, d = 3;
  std::vector<double> x = Clusters(2, n / 4, d, 10, 8);  // 40 rows, then the same again
  x.insert(x.end(), x.begin(), x.begin() + 40 * d);
  ThreadPool pool(2);
  const TsneResult result = Tsne(x, n, d, {}, 1, pool);
  EXPECT_EQ(result.distinct, 40);
  EXPECT_DOUBLE_EQ(result.perplexity, 13);  // (40 - 1) / 3 caps the default of 30
  for (int k = 0; k < 80; ++k) EXPECT_EQ(result.position[k], result.position[80 + k]);
}

TEST(Tsne, DataOnALineLeavesTheLine) {
  const int n = 60;
  std::vector<double> x;
  Rng rng(9, Stream::kTest);
  for (int i = 0; i < n; ++i) {
    x.push_back(rng.Normal());
    x.push_back(-x.back());  // log ratios of two experts
  }
  ThreadPool pool(1);
  const TsneResult result = Tsne(x, n, 2, {}, 1, pool);
  for (const double value : result.position) ASSERT_TRUE(std::isfinite(value));
  EXPECT_LT(result.kl, 0.6);
}

TEST(Tsne, BadRowsAreNamed) {
  ThreadPool pool(1);
  std::vector<double> x(20, 1.0);
  EXPECT_THROW(Tsne(x, 10, 2, {}, 1, pool), Error);  // all equal
  x = Clusters(2, 5, 2, 1, 1);
  x[13] = NAN;
  try {
    Tsne(x, 10, 2, {}, 1, pool);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("row 6"), std::string::npos) << error.what();
  }
}

TEST(Clusters, TheNumberOfClustersThatWasMadeIsFound) {
  for (const int made : {2, 3, 5}) {
    const int each = 15, d = 5, n = made * each;
    const std::vector<double> x = Clusters(made, each, d, 30, 20 + made);
    const Clustering found = ClusterPoints(x, n, d, 8, 1);
    EXPECT_EQ(found.clusters, made);
    EXPECT_GT(found.silhouette, 0.7);
    for (int i = 0; i < n; ++i) {
      EXPECT_EQ(found.label[i], found.label[i / each * each]);
      for (int j = 0; j < i; ++j) EXPECT_EQ(found.label[i] == found.label[j], i / each == j / each);
    }
  }
}

TEST(Clusters, LargerClustersComeFirstAndFewPointsAreOneCluster) {
  std::vector<double> x;
  for (int i = 0; i < 12; ++i) x.push_back(i < 4 ? 0.01 * i : 10 + 0.01 * i);
  const Clustering found = ClusterPoints(x, 12, 1, 4, 1);
  EXPECT_EQ(found.clusters, 2);
  EXPECT_EQ(found.label[11], 0);
  EXPECT_EQ(found.label[0], 1);
  EXPECT_EQ(ClusterPoints({1, 1, 1, 1}, 4, 1, 3, 1).clusters, 1);
  EXPECT_EQ(ClusterPoints({1, 2}, 2, 1, 3, 1).clusters, 1);
}

// A referee for the preservation measures: the identity keeps everything; a shuffle keeps what
// chance keeps.
TEST(Neighbours, IdentityKeepsAllAndAShuffleKeepsChance) {
  const int n = 300, d = 3, k = 10;
  const std::vector<double> x = Clusters(1, n, d, 0, 10);
  ThreadPool pool(2);
  const NeighbourPreservation same = ComparePositions(x, n, d, x, d, k, pool);
  EXPECT_DOUBLE_EQ(same.overlap, 1);
  EXPECT_DOUBLE_EQ(same.trustworthiness, 1);
  const std::vector<double> other = Clusters(1, n, 2, 0, 11);
  const NeighbourPreservation chance = ComparePositions(x, n, d, other, 2, k, pool);
  EXPECT_NEAR(chance.overlap, static_cast<double>(k) / (n - 1), 0.02);
  EXPECT_NEAR(chance.trustworthiness, 0.5, 0.05);
}

}  // namespace
}  // namespace dexremoe
