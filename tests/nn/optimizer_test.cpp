// Adam, clipping, running moments, and the gradient checker itself.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/random.h"
#include "nn/adam.h"
#include "nn/gradient_check.h"
#include "nn/normalizer.h"

namespace dexremoe {
namespace {

TEST(Adam, StepsMatchTheFormulasByHand) {
  const AdamOptions options{0.9, 0.99, 1e-3};
  const double rate = 0.1, gradients[3] = {2.0, -1.0, 0.5};
  std::vector<float> params = {1.0f};
  AdamState state;
  double m = 0, v = 0, expected = 1.0;
  for (int t = 1; t <= 3; ++t) {
    const double g = gradients[t - 1];
    m = 0.9 * m + 0.1 * g;
    v = 0.99 * v + 0.01 * g * g;
    expected -=
        rate * (m / (1 - std::pow(0.9, t))) / (std::sqrt(v / (1 - std::pow(0.99, t))) + 1e-3);
    AdamStep(options, rate, {static_cast<float>(g)}, state, params);
    EXPECT_EQ(state.step, t);
    EXPECT_NEAR(params[0], expected, 1e-6);
  }
}

TEST(Adam, FirstStepHasTheLengthOfTheRateWhateverTheGradient) {
  std::vector<float> params(37, 0.0f), grads(37);
  for (int i = 0; i < 37; ++i)
    grads[i] = static_cast<float>(std::pow(10.0, i % 5)) * (i % 2 ? 1 : -1);
  AdamState state;
  AdamStep({}, 0.01, grads, state, params);
  for (int i = 0; i < 37; ++i) EXPECT_NEAR(params[i], i % 2 ? -0.01 : 0.01, 1e-6);
}

TEST(Adam, SplittingTheParametersChangesNoBit) {
  Rng rng(3, Stream::kTest);
  std::vector<float> params(101), grads(101);
  for (float& value : params) value = static_cast<float>(rng.Normal());
  for (float& value : grads) value = static_cast<float>(rng.Normal());
  std::vector<float> head(params.begin(), params.begin() + 50),
      tail(params.begin() + 50, params.end());
  AdamState whole_state, head_state, tail_state;
  for (int t = 0; t < 4; ++t) {
    AdamStep({}, 1e-3, grads, whole_state, params);
    AdamStep({}, 1e-3, {grads.begin(), grads.begin() + 50}, head_state, head);
    AdamStep({}, 1e-3, {grads.begin() + 50, grads.end()}, tail_state, tail);
  }
  head.insert(head.end(), tail.begin(), tail.end());
  EXPECT_EQ(head, params);
}

TEST(ClipGradient, ScalesToTheNormAndReturnsTheOneBefore) {
  std::vector<float> grads = {3.0f, 0.0f, -4.0f};
  EXPECT_DOUBLE_EQ(ClipGradient(1.0, grads), 5.0);
  EXPECT_FLOAT_EQ(grads[0], 0.6f);
  EXPECT_FLOAT_EQ(grads[2], -0.8f);
  EXPECT_NEAR(ClipGradient(2.0, grads), 1.0, 1e-7);
  EXPECT_FLOAT_EQ(grads[2], -0.8f);  // below the limit: untouched
}

std::vector<float> Samples(int rows, int columns, std::uint64_t index) {
  Rng rng(5, Stream::kTest, {index});
  std::vector<float> x(static_cast<std::size_t>(rows) * columns);
  for (std::size_t i = 0; i < x.size(); ++i)
    x[i] = static_cast<float>(1000.0 * (i % columns) + rng.Normal() * (1 + i % columns));
  return x;
}

TEST(RunningMoments, MergedBatchesEqualTheConcatenation) {
  const int columns = 3;
  const auto a = Samples(40, columns, 1), b = Samples(7, columns, 2);
  auto both = a;
  both.insert(both.end(), b.begin(), b.end());
  RunningMoments merged(columns), whole(columns);
  UpdateMoments(40, a.data(), merged);
  UpdateMoments(7, b.data(), merged);
  UpdateMoments(47, both.data(), whole);
  EXPECT_DOUBLE_EQ(merged.count, whole.count);
  for (int j = 0; j < columns; ++j) {
    EXPECT_NEAR(merged.mean[j], whole.mean[j], 1e-9 * (1 + std::abs(whole.mean[j])));
    EXPECT_NEAR(merged.variance[j], whole.variance[j], 1e-9 * whole.variance[j]);
  }
}

TEST(RunningMoments, MatchTheTwoPassFormulas) {
  const auto x = Samples(500, 2, 3);
  RunningMoments moments(2);
  moments.count = 1e-12;  // the start must weigh nothing here
  UpdateMoments(500, x.data(), moments);
  for (int j = 0; j < 2; ++j) {
    double mean = 0, variance = 0;
    for (int i = 0; i < 500; ++i) mean += x[2 * i + j] / 500.0;
    for (int i = 0; i < 500; ++i) variance += std::pow(x[2 * i + j] - mean, 2) / 500.0;
    EXPECT_NEAR(moments.mean[j], mean, 1e-8 * (1 + std::abs(mean)));
    EXPECT_NEAR(moments.variance[j], variance, 1e-8 * variance);
  }
}

TEST(RunningMoments, NormalizedDataHaveMeanZeroVarianceOneAndAreClipped) {
  auto x = Samples(2000, 2, 4);
  RunningMoments moments(2);
  moments.count = 1e-12;
  UpdateMoments(2000, x.data(), moments);
  x[0] = 1e9f;
  Normalize(moments, 5.0, 2000, x.data(), x.data());
  EXPECT_EQ(x[0], 5.0f);
  for (int j = 0; j < 2; ++j) {
    double mean = 0, square = 0;
    for (int i = 1; i < 2000; ++i) mean += x[2 * i + j] / 1999.0;
    for (int i = 1; i < 2000; ++i) square += x[2 * i + j] * x[2 * i + j] / 1999.0;
    EXPECT_NEAR(mean, 0, 0.01);
    EXPECT_NEAR(square, 1, 0.01);
  }
}

TEST(GradientCheck, AcceptsTheRightGradientAndRejectsAWrongOne) {
  const auto loss = [](const std::vector<double>& x) {
    return std::sin(x[0]) * x[1] + x[2] * x[2] * x[2];
  };
  const std::vector<double> x = {0.4, -1.3, 2.0};
  const std::vector<double> right = {std::cos(0.4) * -1.3, std::sin(0.4), 12.0};
  EXPECT_TRUE(CheckGradient(loss, x, right).ok);
  for (std::size_t i = 0; i < 3; ++i) {
    auto wrong = right;
    wrong[i] *= 1 + 1e-4;
    const auto report = CheckGradient(loss, x, wrong);
    EXPECT_FALSE(report.ok) << "element " << i;
    EXPECT_EQ(report.index, i);
    EXPECT_NE(report.Text().find("WRONG"), std::string::npos);
  }
  auto missing = right;
  missing[1] = NAN;
  EXPECT_FALSE(CheckGradient(loss, x, missing).ok);
}

TEST(GradientCheck, SpreadSamplesReachBothEnds) {
  std::vector<double> x(100, 0.5), gradient(100, 1.0);
  const auto sum = [](const std::vector<double>& at) {
    double total = 0;
    for (const double value : at) total += value;
    return total;
  };
  EXPECT_TRUE(CheckGradient(sum, x, gradient, 1e-6, 1e-5, 10).ok);
  gradient[0] = 2;
  EXPECT_FALSE(CheckGradient(sum, x, gradient, 1e-6, 1e-5, 10).ok);
  gradient[0] = 1;
  gradient[90] = 2;
  EXPECT_FALSE(CheckGradient(sum, x, gradient, 1e-6, 1e-5, 10).ok);
}

}  // namespace
}  // namespace dexremoe
