// Mixtures trained from scratch, and the residual: gradients, and what each must equal.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "gradient_of_policy.h"
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
