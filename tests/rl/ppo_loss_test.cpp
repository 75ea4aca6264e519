// Loss terms against closed forms and central differences; advantages by hand.
#include "rl/ppo_loss.h"

#include <gtest/gtest.h>

#include <vector>

#include "base/random.h"
#include "rl/gae.h"
#include "rl/ppo.h"
#include "rl/rank_statistics.h"

namespace dexremoe {
namespace {

constexpr int kActions = 3;
constexpr double kStep = 1e-6;

std::vector<double> Draw(std::uint64_t index, int count = kActions, double scale = 1) {
  Rng rng(5, Stream::kTest, {index});
  std::vector<double> values(count);
  for (double& v : values) v = scale * rng.Normal();
  return values;
}

// d f / d x[i] by central differences.
template <typename F>
double Slope(F f, std::vector<double> x, std::size_t i) {
  x[i] += kStep;
  const double above = f(x);
  x[i] -= 2 * kStep;
  return (above - f(x)) / (2 * kStep);
}

TEST(PpoLoss, LogProbabilityMatchesTheGaussianDensity) {
  const double action[] = {0.3, -1.2}, mean[] = {0.1, 0.4}, log_std[] = {0.0, std::log(0.5)};
  const auto density = [](double x, double m, double s) {
    return std::exp(-(x - m) * (x - m) / (2 * s * s)) / (s * std::sqrt(2 * std::numbers::pi));
  };
  EXPECT_NEAR(LogProbability(ActionSpread<double>(2, log_std), action, mean),
              std::log(density(0.3, 0.1, 1) * density(-1.2, 0.4, 0.5)), 1e-12);
}

TEST(PpoLoss, LogProbabilityGradientMatchesCentralDifferences) {
  const auto action = Draw(1), mean = Draw(2), log_std = Draw(3, kActions, 0.5);
  std::vector<double> dmean(kActions), dlog_std(kActions);
  const ActionSpread<double> spread(kActions, log_std.data());
  AddLogProbabilityGradient(spread, action.data(), mean.data(), 2.5, dmean.data(), dlog_std.data());
  for (int a = 0; a < kActions; ++a) {
    EXPECT_NEAR(
        dmean[a],
        Slope([&](const auto& m) { return 2.5 * LogProbability(spread, action.data(), m.data()); },
              mean, a),
        1e-7);
    EXPECT_NEAR(dlog_std[a],
                Slope(
                    [&](const auto& s) {
                      return 2.5 * LogProbability(ActionSpread<double>(kActions, s.data()),
                                                  action.data(), mean.data());
                    },
                    log_std, a),
                1e-7);
  }
}

TEST(PpoLoss, SurrogateIsThePessimisticOfTheTwo) {
  // ratio, advantage -> loss with clip 0.2
  const double cases[][3] = {{1.0, 2, -2}, {1.5, 2, -2.4}, {0.5, 2, -1},
                             {1.5, -2, 3}, {0.5, -2, 1.6}, {1.1, -1, 1.1}};
  for (const auto& c : cases)
    EXPECT_NEAR(Surrogate(std::log(c[0]), 0.0, c[1], 0.2).loss, c[2], 1e-12) << c[0] << ' ' << c[1];
}

TEST(PpoLoss, SurrogateGradientMatchesCentralDifferences) {
  for (const double logp : {-0.7, -0.1, 0.05, 0.5})
    for (const double advantage : {-1.3, 0.8}) {
      const auto at = [&](const auto& x) { return Surrogate(x[0], 0.02, advantage, 0.2).loss; };
      const auto loss = Surrogate(logp, 0.02, advantage, 0.2);
      EXPECT_NEAR(loss.dloss_dlogp, Slope(at, {logp}, 0), 1e-7);
      EXPECT_EQ(loss.clipped, loss.dloss_dlogp == 0);
    }
}

TEST(PpoLoss, ValueLossGradientMatchesCentralDifferences) {
  for (const bool clipping : {false, true})
    for (const double value : {-1.0, -0.15, 0.1, 0.9})
      for (const double target : {-0.5, 0.05, 2.0}) {
        const auto at = [&](const auto& x) {
          return SquaredValueLoss(x[0], 0.0, target, 0.2, clipping).loss;
        };
        EXPECT_NEAR(SquaredValueLoss(value, 0.0, target, 0.2, clipping).dloss_dvalue,
                    Slope(at, {value}, 0), 1e-7);
      }
}

TEST(PpoLoss, ValueThatRanAwayFromTheOldOneIsNotPushedFurther) {
  EXPECT_EQ(SquaredValueLoss(0.5, 0.0, 1.0, 0.2, true).dloss_dvalue, 0);
  EXPECT_LT(SquaredValueLoss(0.5, 0.0, 1.0, 0.2, false).dloss_dvalue, 0);
}

TEST(PpoLoss, BoundsActOnBothSidesOnlyBeyondThem) {
  const std::vector<double> mean = {1.4, 0.9, -1.3};
  std::vector<double> dmean(kActions), unused(kActions);
  EXPECT_NEAR(BoundsLoss(kActions, mean.data(), 1.1, 0.5, dmean.data()), 0.09 + 0.04, 1e-12);
  EXPECT_GT(dmean[0], 0);
  EXPECT_EQ(dmean[1], 0);
  EXPECT_LT(dmean[2], 0);
  for (int a = 0; a < kActions; ++a)
    EXPECT_NEAR(dmean[a],
                Slope(
                    [&](const auto& m) {
                      return 0.5 * BoundsLoss(kActions, m.data(), 1.1, 0.0, unused.data());
                    },
                    mean, a),
                1e-7);
}

TEST(PpoLoss, EntropyIsTheMeanSurprise) {
  const auto mean = Draw(6), log_std = Draw(7, kActions, 0.5);
  Rng rng(8, Stream::kTest, {8});
  const ActionSpread<double> spread(kActions, log_std.data());
  double surprise = 0;
  constexpr int kDraws = 200000;
  for (int i = 0; i < kDraws; ++i) {
    double action[kActions];
    for (int a = 0; a < kActions; ++a) action[a] = mean[a] + std::exp(log_std[a]) * rng.Normal();
    surprise -= LogProbability(spread, action, mean.data()) / kDraws;
  }
  EXPECT_NEAR(Entropy(kActions, log_std.data()), surprise, 0.02);
}

TEST(PpoLoss, KlMatchesItsClosedFormAndVanishesAtEquality) {
  const auto mean0 = Draw(9), mean1 = Draw(10), s0 = Draw(11, kActions, 0.5),
             s1 = Draw(12, kActions, 0.5);
  double expected = 0;  // log(s1/s0) + (s0^2 + (m0 - m1)^2) / (2 s1^2) - 1/2
  for (int a = 0; a < kActions; ++a) {
    const double v0 = std::exp(2 * s0[a]), v1 = std::exp(2 * s1[a]), d = mean0[a] - mean1[a];
    expected += std::log(std::sqrt(v1 / v0)) + (v0 + d * d) / (2 * v1) - 0.5;
  }
  const ActionSpread<double> spread0(kActions, s0.data()), spread1(kActions, s1.data());
  EXPECT_NEAR(KlOfSpreads(spread0, spread1) + KlOfMeans(mean0.data(), mean1.data(), spread1),
              expected, 1e-12);
  EXPECT_EQ(KlOfSpreads(spread0, spread0), 0);
  EXPECT_EQ(KlOfMeans(mean0.data(), mean0.data(), spread0), 0);
}

TEST(Gae, MatchesTheHandComputation) {
  // gamma 0.5, lambda 0.5; one environment without an end, one that ends in the middle.
  const std::vector<float> reward = {1, 2, 0, 4, 3, 1};
  const std::vector<std::uint8_t> done = {0, 0, 0, 1, 0, 0};
  const std::vector<float> value = {2, 1, 4, 2, 2, 6};
  const std::vector<float> last = {8, 2};
  std::vector<float> advantage, target;
  ComputeGae(3, 2, 0.5, 0.5, reward, done, value, last, advantage, target);
  // Environment 0: deltas 1 + 2 - 2, 0 + 1 - 4, 3 + 4 - 2; advantages sum with factor 1/4.
  EXPECT_FLOAT_EQ(advantage[4], 5);
  EXPECT_FLOAT_EQ(advantage[2], -3 + 5.0f / 4);
  EXPECT_FLOAT_EQ(advantage[0], 1 + (-3 + 5.0f / 4) / 4);
  // Environment 1: after the end at t = 1 nothing flows back.
  EXPECT_FLOAT_EQ(advantage[5], 1 + 1 - 6);
  EXPECT_FLOAT_EQ(advantage[3], 4 - 2);
  EXPECT_FLOAT_EQ(advantage[1], (2 + 1 - 1) + 2.0f / 4);
  for (int i = 0; i < 6; ++i) EXPECT_FLOAT_EQ(target[i], advantage[i] + value[i]);
}

TEST(Gae, LambdaOneGivesDiscountedReturns) {
  const std::vector<float> reward = {1, 1, 1, 1};
  std::vector<float> advantage, target;
  ComputeGae(4, 1, 0.9, 1.0, reward, {0, 0, 0, 0}, {7, -3, 2, 5}, {10}, advantage, target);
  EXPECT_NEAR(target[0], 1 + 0.9 + 0.81 + 0.729 + 0.6561 * 10, 1e-5);
}

TEST(Gae, NormalisedAdvantagesHaveMeanZeroAndVarianceOne) {
  std::vector<float> advantage = {1, 2, 3, 10};
  NormalizeAdvantages(Alone(), advantage);
  double mean = 0, square = 0;
  for (const float a : advantage) {
    mean += a / 4;
    square += a * a / 4;
  }
  EXPECT_NEAR(mean, 0, 1e-6);
  EXPECT_NEAR(square, 1, 1e-6);
}

TEST(AdaptiveRate, FollowsTheKlWithinItsLimits) {
  PpoOptions options;  // threshold 0.02, factor 1.5, limits 1e-6 and 1e-2
  const auto adapt = [&](double kl, double rate) { return AdaptRate(options, 0.02, kl, rate); };
  EXPECT_DOUBLE_EQ(adapt(0.05, 3e-4), 2e-4);
  EXPECT_DOUBLE_EQ(adapt(0.005, 2e-4), 3e-4);
  for (const double kl : {0.011, 0.02, 0.039}) EXPECT_DOUBLE_EQ(adapt(kl, 2e-4), 2e-4);
  EXPECT_DOUBLE_EQ(adapt(1, 1.2e-6), 1e-6);
  EXPECT_DOUBLE_EQ(adapt(0, 9e-3), 1e-2);
}

TEST(AdaptiveRate, ThresholdFallsGeometricallyOverATrainingAndStaysAtItsEnd) {
  PpoOptions options;
  EXPECT_EQ(options.KlThreshold(1000), 0.02);
  options.kl_end = 0.005;
  EXPECT_EQ(options.KlThreshold(0), 0.005);  // a stage that goes on
  options.span = 1000;
  EXPECT_EQ(options.KlThreshold(0), 0.02);
  EXPECT_DOUBLE_EQ(options.KlThreshold(500), 0.01);
  EXPECT_DOUBLE_EQ(options.KlThreshold(1000), 0.005);
  EXPECT_DOUBLE_EQ(options.KlThreshold(5000), 0.005);
  options.late_from = 0.5;
  EXPECT_EQ(options.KlThreshold(500), 0.02);
  EXPECT_DOUBLE_EQ(options.KlThreshold(750), 0.01);
}

}  // namespace
}  // namespace dexremoe
