// Mixtures trained from scratch, and the residual: gradients, and what each must equal.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "gradient_of_policy.h"
#include "policy/router.h"
#include "policy/sparse_moe.h"
#include "policy/switch_moe.h"
#include "small_policy.h"

namespace dexremoe {
namespace {

struct Output {
  std::vector<double> mean, value;
};

Output Act(const Policy<double>& policy, const Problem<double>& problem,
           const std::vector<double>& params) {
  Output out{std::vector<double>(problem.dmean.size()), std::vector<double>(problem.n)};
  Workspace<double> work;
  policy.Forward(params.data(), problem.shapes(), problem.rows(), work, out.mean.data(),
                 out.value.data());
  return out;
}

void ExpectNear(const Output& a, const Output& b, double tolerance = 1e-12) {
  for (std::size_t i = 0; i < a.mean.size(); ++i) EXPECT_NEAR(a.mean[i], b.mean[i], tolerance);
  for (std::size_t i = 0; i < a.value.size(); ++i) EXPECT_NEAR(a.value[i], b.value[i], tolerance);
}

// Copies the blocks of `from` under `prefix` to those of `to` under `new_prefix`.
void Copy(const Policy<double>& from, const std::vector<double>& values, const std::string& prefix,
          const Policy<double>& to, const std::string& new_prefix, std::vector<double>& params) {
  for (const ParamBlock& block : from.layout().blocks()) {
    if (!block.name.starts_with(prefix)) continue;
    const int index = to.layout().Find(new_prefix + block.name.substr(prefix.size()));
    ASSERT_GE(index, 0) << block.name;
    std::copy_n(values.begin() + block.offset, block.size(),
                params.begin() + to.layout().block(index).offset);
  }
}

double& Element(const Policy<double>& policy, const std::string& block, std::int64_t i,
                std::vector<double>& params) {
  return params[policy.layout().block(policy.layout().Find(block)).offset + i];
}

// The base with the widths of SmallRouted.
PolicyStructure BaseOfRouted() {
  PolicyStructure s = SmallRouted("actor_critic");
  s.experts = 0;
  return s;
}

const char* const kRouted[] = {"sparse_moe", "switch_moe", "mmoe", "mlore"};

TEST(Mixtures, GradientsMatchCentralDifferences) {
  for (const char* kind : kRouted) {
    SCOPED_TRACE(kind);
    CheckGradients(SmallRouted(kind), true);
  }
}

// The weight is far above the losses' own, so that their gradients count.
TEST(Mixtures, GradientsOfTheBalanceLossesMatchCentralDifferences) {
  for (const char* kind : kRouted) {
    SCOPED_TRACE(kind);
    for (const bool noise : {false, true}) CheckGradients(SmallRouted(kind), noise, 300);
  }
}

TEST(Mixtures, GradientsMatchWithOtherNumbersOfExpertsAndGateInputs) {
  for (const int k : {1, 3, 4}) {
    PolicyStructure s = SmallRouted("sparse_moe");
    s.top_k = k;
    CheckGradients(s, true, 300);
  }
  for (const char* kind : kRouted) {
    SCOPED_TRACE(kind);
    PolicyStructure s = SmallRouted(kind);
    s.gate_input = "category";
    CheckGradients(s, true, 300);
  }
}

TEST(Mixtures, ResidualGradientsMatchCentralDifferencesAndSpareTheBase) {
  PolicyStructure s = SmallBase();
  s.kind = "residual";
  CheckGradients(s);
  const auto policy = MakePolicy<double>(s);
  for (std::size_t b = 0; b < policy->trainable().size(); ++b) {
    const std::string& name = policy->layout().block(static_cast<int>(b)).name;
    EXPECT_EQ(policy->trainable()[b] != 0, name.starts_with("residual/") || name == "log_std");
  }
}

TEST(Mixtures, ZeroResidualIsTheBase) {
  PolicyStructure s = SmallBase();
  const auto base = MakePolicy<double>(s);
  s.kind = "residual";
  const auto residual = MakePolicy<double>(s);
  const Problem<double> problem(s, 7, 4);
  const std::vector<double> params = RandomParams(*base);
  std::vector<float> fresh(residual->layout().size());
  residual->Initialize(3, -1, 1, fresh.data());
  std::vector<double> all(fresh.begin(), fresh.end());
  for (const char* blocks : {"encoder/", "actor/"})
    Copy(*base, params, blocks, *residual, blocks, all);
  ExpectNear(Act(*residual, problem, all), Act(*base, problem, params), 0);
  Element(*residual, "residual/mean/0/bias", 1, all) = 0.25;
  EXPECT_NEAR(Act(*residual, problem, all).mean[1], Act(*base, problem, params).mean[1] + 0.25,
              1e-12);
}

TEST(Mixtures, ResidualFrozenFeaturesChangeNothing) {
  PolicyStructure s = SmallBase();
  s.kind = "residual";
  const auto policy = MakePolicy<double>(s);
  const Problem<double> problem(s, 7, 4);
  const std::vector<double> params = RandomParams(*policy);
  Workspace<double> work;
  std::vector<double> frozen(problem.n * policy->frozen_size());
  policy->Freeze(params.data(), problem.shapes(), problem.rows(), work, frozen.data());
  PolicyRows<double> rows = problem.rows();
  rows.frozen = frozen.data();
  Output out = Act(*policy, problem, params);
  const Output before = out;
  policy->Forward(params.data(), problem.shapes(), rows, work, out.mean.data(), out.value.data());
  EXPECT_EQ(out.mean, before.mean);
  EXPECT_EQ(out.value, before.value);
}

TEST(Mixtures, OneExpertIsThatExpert) {
  const auto base = MakePolicy<double>(BaseOfRouted());
  const std::vector<double> params = RandomParams(*base);
  for (const char* kind : {"sparse_moe", "switch_moe"}) {
    PolicyStructure s = SmallRouted(kind);
    s.experts = s.top_k = 1;
    const auto mixture = MakePolicy<double>(s);
    const Problem<double> problem(s, 8, 4);
    std::vector<double> all = RandomParams(*mixture);
    Copy(*base, params, "encoder/", *mixture, "encoder/", all);
    Copy(*base, params, "actor/", *mixture, "expert0/", all);
    ExpectNear(Act(*mixture, problem, all), Act(*base, problem, params));
  }
}

// MMoE with one expert and equal heads is an actor with that trunk and that head.
TEST(Mixtures, OneExpertWithEqualHeadsIsTheBase) {
  const PolicyStructure small = BaseOfRouted();
  const auto base = MakePolicy<double>(small);
  const std::vector<double> params = RandomParams(*base);
  PolicyStructure s = SmallRouted("mmoe");
  s.experts = 1;
  const auto mixture = MakePolicy<double>(s);
  const Problem<double> problem(s, 8, 4);
  std::vector<double> all = RandomParams(*mixture);
  Copy(*base, params, "encoder/", *mixture, "encoder/", all);
  Copy(*base, params, "actor/trunk/", *mixture, "expert0/", all);
  const auto block = [&](const char* name) {
    return params.begin() + base->layout().block(base->layout().Find(name)).offset;
  };
  const int hidden = small.hidden.back(), actions = small.num_actions;
  for (int c = 0; c < s.num_categories; ++c) {
    const std::string head = "head" + std::to_string(c);
    double* weight = &Element(*mixture, head + "/weight", 0, all);
    std::copy_n(block("actor/value/0/weight"), hidden,
                std::copy_n(block("actor/mean/0/weight"), actions * hidden, weight));
    double* bias = &Element(*mixture, head + "/bias", 0, all);
    *std::copy_n(block("actor/mean/0/bias"), actions, bias) = *block("actor/value/0/bias");
  }
  ExpectNear(Act(*mixture, problem, all), Act(*base, problem, params));
}

// With k of n and no noise the gate's softmax is over all experts: the soft mixture.
TEST(Mixtures, EqualExpertsGiveTheSameUnderAnyGate) {
  for (const char* kind : {"sparse_moe", "mmoe"}) {
    PolicyStructure s = SmallRouted(kind);
    const auto mixture = MakePolicy<double>(s);
    Problem<double> problem(s, 8, 4);
    problem.DrawNoise(*mixture);
    std::vector<double> params = RandomParams(*mixture);
    for (const char* other : {"expert1/", "expert2/", "expert3/"})
      Copy(*mixture, params, "expert0/", *mixture, other, params);
    const Output before = Act(*mixture, problem, params);
    const std::string gate = s.kind == "mmoe" ? "gate" : "router/";
    for (const ParamBlock& block : mixture->layout().blocks())
      if (block.name.starts_with(gate))
        for (std::int64_t i = 0; i < block.size(); ++i) params[block.offset + i] += 0.3 * i;
    ExpectNear(Act(*mixture, problem, params), before, 1e-9);
  }
}

TEST(Mixtures, AllExpertsWithoutNoiseAreTheSoftMixture) {
  PolicyStructure s = SmallRouted("sparse_moe");
  s.top_k = s.experts;
  const auto sparse = MakePolicy<double>(s);
  s.kind = "soft_mixture";
  s.gate_widths = {1};  // replaced below
  const auto soft = MakePolicy<double>(s);
  const Problem<double> problem(s, 8, 4);
  const std::vector<double> params = RandomParams(*sparse);
  Workspace<double> work;
  // The soft mixture of the same experts under the sparse one's weights.
  std::vector<double> weights(problem.k * s.experts), all = RandomParams(*soft);
  sparse->GateWeights(params.data(), problem.shapes(), work, weights.data());
  Copy(*sparse, params, "encoder/", *soft, "encoder/", all);
  for (int i = 0; i < s.experts; ++i) {
    const std::string expert = "expert" + std::to_string(i) + "/";
    Copy(*sparse, params, expert, *soft, expert, all);
  }
  std::vector<double> frozen(problem.n * soft->frozen_size());
  soft->Freeze(all.data(), problem.shapes(), problem.rows(), work, frozen.data());
  const Output out = Act(*sparse, problem, params);
  for (int r = 0; r < problem.n; ++r)
    for (int a = 0; a < s.num_actions; ++a) {
      double mean = 0;
      for (int i = 0; i < s.experts; ++i)
        mean += weights[problem.object[r] * s.experts + i] *
                frozen[r * soft->frozen_size() + i * s.num_actions + a];
      EXPECT_NEAR(out.mean[r * s.num_actions + a], mean, 1e-12);
    }
  // And those weights are a softmax of scores that are linear in e_shape: all experts have some.
  for (const double w : weights) EXPECT_GT(w, 0);
}

TEST(Mixtures, AsManyExpertsActAsAreAskedFor) {
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

TEST(Mixtures, SwitchScalesItsExpertByTheProbability) {
  const PolicyStructure s = SmallRouted("switch_moe");
  const auto policy = MakePolicy<double>(s);
  const Problem<double> problem(s, 1, 1);
  std::vector<double> params = RandomParams(*policy);
  // Equal scores: every probability is 1/4 and the first expert acts.
  for (int i = 0; i < 4 * s.shape_size(); ++i) Element(*policy, "router/scores", i, params) = 0;
  const Output quarter = Act(*policy, problem, params);
  PolicyStructure one = s;
  one.experts = 1;
  const auto alone = MakePolicy<double>(one);
  std::vector<double> own = RandomParams(*alone);
  Copy(*policy, params, "encoder/", *alone, "encoder/", own);
  Copy(*policy, params, "expert0/", *alone, "expert0/", own);
  const Output whole = Act(*alone, problem, own);
  for (int a = 0; a < s.num_actions; ++a) EXPECT_NEAR(quarter.mean[a], whole.mean[a] / 4, 1e-12);
  EXPECT_NEAR(quarter.value[0], whole.value[0] / 4, 1e-12);
}

// f_i = P_i = 1/E gives 1; all rows to one expert with certainty gives E.
TEST(Mixtures, SwitchBalanceLossIsOneWhenEvenAndTheNumberOfExpertsWhenNot) {
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
TEST(Mixtures, LoadEstimateIsTheChanceOfBeingChosen) {
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
TEST(Mixtures, FreshNoisyRouterSpreadsTheLoad) {
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

TEST(Mixtures, CategoriesHaveTheirOwnHeadsAndPaths) {
  for (const char* kind : {"mmoe", "mlore"}) {
    const PolicyStructure s = SmallRouted(kind);
    const auto policy = MakePolicy<double>(s);
    const Problem<double> problem(s, 8, 4);  // object k is of category k
    std::vector<double> params = RandomParams(*policy);
    const Output before = Act(*policy, problem, params);
    const std::string block = s.kind == "mmoe" ? "head2/bias" : "layer0/category2/up";
    Element(*policy, block, 0, params) += 1;
    const Output after = Act(*policy, problem, params);
    for (int r = 0; r < problem.n; ++r)
      EXPECT_EQ(after.mean[r * s.num_actions] != before.mean[r * s.num_actions],
                problem.object[r] == 2)
          << r;
  }
}

TEST(Mixtures, MloreTakesTheLargestProbabilitiesAsTheyAre) {
  PolicyStructure s = SmallRouted("mlore");
  s.top_k = 1;
  const auto policy = MakePolicy<double>(s);
  const Problem<double> problem(s, 6, 4);
  std::vector<double> params = RandomParams(*policy);
  // All layers choose by a router without preference: the first expert, with p = 1/4.
  for (const char* router : {"layer0/router", "layer1/router"})
    for (int i = 0; i < 4 * s.shape_size(); ++i) Element(*policy, router, i, params) = 0;
  const Output before = Act(*policy, problem, params);
  std::vector<double> idle = params, acting = params;
  Element(*policy, "layer1/up", 1, idle) += 1;    // column 1: the second expert's
  Element(*policy, "layer1/up", 0, acting) += 1;  // column 0: the first expert's
  EXPECT_EQ(Act(*policy, problem, idle).mean, before.mean);
  EXPECT_NE(Act(*policy, problem, acting).mean, before.mean);
}

TEST(Mixtures, StructuresThatMakeNoNetworkAreErrors) {
  PolicyStructure s = SmallRouted("sparse_moe");
  s.top_k = 5;
  EXPECT_THROW(MakePolicy<float>(s), Error);
  s = SmallRouted("mlore");
  s.ranks = {1, 2};
  EXPECT_THROW(MakePolicy<float>(s), Error);
  s = SmallBase();
  s.phys_seen = {4};
  EXPECT_THROW(MakePolicy<float>(s), Error);
}

}  // namespace
}  // namespace dexremoe
