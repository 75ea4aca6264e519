// Which experts a router lets act, and its losses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "gradient_of_policy.h"
#include "policy/sparse_moe.h"
#include "policy/switch_moe.h"
#include "small_policy.h"

namespace dexremoe {
namespace {

TEST(Routers, AsManyExpertsActAsAreAskedFor) {
  for (const char* kind : {"sparse_moe", "switch_moe"}) {
    const PolicyStructure s = SmallRouted(kind);
    const auto policy = MakePolicy<double>(s);
    const Problem<double> problem(s, 1, 4);
    const std::vector<double> params = RandomParams(*policy);
    Workspace<double> work;
    std::vector<double> weights(4 * 4);
    policy->GateWeights(params.data(), problem.shapes(), work, weights.data());
    for (int k = 0; k < 4; ++k) {
      const auto row = weights.begin() + 4 * k;
      EXPECT_EQ(std::count_if(row, row + 4, [](double w) { return w > 0; }),
                s.kind == "switch_moe" ? 1 : 2);
      EXPECT_NEAR(std::accumulate(row, row + 4, 0.0), 1, 1e-12);
    }
  }
}

// f_i = P_i = 1/E gives 1; all rows to one expert with certainty gives E.
TEST(Routers, SwitchBalanceLossIsOneWhenEvenAndTheNumberOfExpertsWhenNot) {
  ParamLayout layout;
  const SwitchRouter<double> router(layout, 4, 4);
  std::vector<double> params(layout.size(), 0.0), pass(router.PassSize(4)), weights(16);
  const auto loss = [&](double scale, const std::vector<double>& input) {
    for (int i = 0; i < 4; ++i) params[i * 4 + i] = scale;
    const RouterRows<double> rows = {4, input.data(), nullptr};
    router.Forward(params.data(), rows, pass.data(), weights.data());
    return router.Balance(rows, weights.data(), 0, pass.data());
  };
  std::vector<double> each(16, 0.0), first(16, 0.0);
  for (int r = 0; r < 4; ++r) each[r * 4 + r] = first[r * 4] = 1;
  EXPECT_NEAR(loss(50, each), SwitchRouter<double>::kBalanceWeight, 1e-12);
  EXPECT_NEAR(loss(50, first), 4 * SwitchRouter<double>::kBalanceWeight, 1e-12);
}

// P(x)_i is the chance of being among the k best when the expert's own noise is drawn anew.
TEST(Routers, LoadEstimateIsTheChanceOfBeingChosen) {
  constexpr int kExperts = 4, kRows = 1, kDraws = 40000;
  ParamLayout layout;
  const NoisyTopK<double> router(layout, 1, kExperts, 2);
  std::vector<double> params = {0.3, -0.2, 0.5, 0.1, 0.2, 0.4, -0.3, 0.1};
  const std::vector<double> input = {1.0};
  std::vector<double> noise = {0.4, -0.8, 0.1, 0.9}, pass(router.PassSize(kRows)), weights(4);
  std::vector<double> chance(kExperts, 0.0);
  Rng rng(8, Stream::kTest, {});
  for (int i = 0; i < kExperts; ++i)  // the expert whose noise is drawn anew
    for (int draw = 0; draw < kDraws; ++draw) {
      std::vector<double> fresh = noise;
      fresh[i] = rng.Normal();
      router.Forward(params.data(), {kRows, input.data(), fresh.data()}, pass.data(),
                     weights.data());
      chance[i] += (weights[i] > 0) / static_cast<double>(kDraws);
    }
  std::vector<double> gradient;
  const double expected = SquaredVariation(chance, gradient);
  router.Forward(params.data(), {kRows, input.data(), noise.data()}, pass.data(), weights.data());
  const double both =
      router.Balance({kRows, input.data(), noise.data()}, weights.data(), 0, pass.data());
  const double importance = SquaredVariation(weights, gradient);
  EXPECT_NEAR(both / NoisyTopK<double>::kLoadWeight - importance, expected, 0.02);
}

// Without noise a fresh router ties; with it the experts share the rows evenly.
TEST(Routers, FreshNoisyRouterSpreadsTheLoad) {
  PolicyStructure s = SmallRouted("sparse_moe");
  const auto policy = MakePolicy<float>(s);
  std::vector<float> params(policy->layout().size());
  policy->Initialize(2, -1, 1, params.data());
  Problem<float> problem(s, 2000, 4);
  problem.DrawNoise(*policy);
  Workspace<float> work;
  std::vector<float> mean(problem.dmean.size()), value(problem.n);
  policy->Forward(params.data(), problem.shapes(), problem.rows(), work, mean.data(), value.data());
  RoutingSums sums;
  policy->Balance(problem.rows(), problem.shapes(), work, 1, sums);
  for (const double load : sums.load) EXPECT_NEAR(load / 2000, 0.25, 0.02);
}

// All parameters zero: every expert is as likely, and the first of them takes every row.
TEST(Routers, SwitchEntropyIsThatOfItsProbabilitiesNotOfItsChoice) {
  const PolicyStructure s = SmallRouted("switch_moe");
  const auto policy = MakePolicy<float>(s);
  const std::vector<float> params(policy->layout().size(), 0.0f);
  const Problem<float> problem(s, 50, 4);
  Workspace<float> work;
  std::vector<float> mean(problem.dmean.size()), value(problem.n);
  policy->Forward(params.data(), problem.shapes(), problem.rows(), work, mean.data(), value.data());
  RoutingSums sums;
  policy->Balance(problem.rows(), problem.shapes(), work, 1, sums);
  EXPECT_NEAR(sums.entropy / 50, std::log(4.0), 1e-6);
  EXPECT_EQ(sums.load[0], 50);
}

}  // namespace
}  // namespace dexremoe
