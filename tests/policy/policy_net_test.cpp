// Policies in bfloat16 against the same in float.
#include "policy/policy_net.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "nn/precision.h"
#include "small_policy.h"

namespace dexremoe {
namespace {

// Means, values and gradients of one pass through the network of a structure.
struct NetPass {
  NetPass(PolicyStructure s, const std::string& precision, const std::vector<float>& params)
      : problem(s, 300, 4), mean(problem.dmean.size()), value(problem.n), grads(params.size()) {
    s.precision = precision;
    const auto net = MakePolicyNet(s, 1);
    net->Load(params);
    std::vector<float> frozen(problem.n * MakePolicy<float>(s)->frozen_size());
    PolicyRows<float> rows = problem.rows();
    if (!frozen.empty()) {
      net->Freeze(0, problem.shapes(), rows, frozen.data());
      rows.frozen = frozen.data();
    }
    net->Forward(0, problem.shapes(), rows, mean.data(), value.data());
    net->Backward(0, problem.shapes(), rows, problem.dmean.data(), problem.dvalue.data(),
                  grads.data());
  }
  Problem<float> problem;
  std::vector<float> mean, value, grads;
};

double Distance(const float* a, const float* b, std::size_t count) {
  double square = 0, scale = 0;
  for (std::size_t i = 0; i < count; ++i) {
    square += std::pow(static_cast<double>(a[i]) - b[i], 2);
    scale += std::pow(static_cast<double>(b[i]), 2);
  }
  return std::sqrt(square / scale);
}

// The bound is seven roundings of 2^-8, as the longest of these passes have seven layers, for
// outputs and for each block's gradient; a gradient 5 % off is outside of it.
TEST(PolicyNet, Bfloat16StaysNearFloatAndAWrongGradientWouldNot) {
  if (!HasNativeBfloat16()) GTEST_SKIP() << "no bfloat16 on this processor";
  constexpr double kBound = 7.0 / 256;
  PolicyStructure expert = SmallBase();
  expert.train_encoders = false;
  PolicyStructure residual = SmallBase();
  residual.kind = "residual";
  // All experts act: which of two near ones does is decided by rounding.
  PolicyStructure sparse = SmallRouted("sparse_moe"), low_rank = SmallRouted("mlore");
  sparse.top_k = low_rank.top_k = 4;
  for (const PolicyStructure& s : {SmallBase(), expert, SmallMixture("full"), residual, sparse,
                                   low_rank, SmallRouted("mmoe")}) {
    SCOPED_TRACE(s.kind + (s.train_encoders ? " with encoders" : ""));
    const auto policy = MakePolicy<float>(s);
    std::vector<float> params(policy->layout().size());
    policy->Initialize(3, -1, 1, params.data());
    const NetPass exact(s, "f32", params);
    NetPass stored(s, "bf16", params);
    EXPECT_LT(Distance(stored.mean.data(), exact.mean.data(), exact.mean.size()), kBound);
    EXPECT_LT(Distance(stored.value.data(), exact.value.data(), exact.value.size()), kBound);
    for (const ParamBlock& block : policy->layout().blocks()) {
      float* found = stored.grads.data() + block.offset;
      const float* right = exact.grads.data() + block.offset;
      const std::size_t size = static_cast<std::size_t>(block.size());
      if (std::all_of(right, right + size, [](float g) { return g == 0; })) {
        EXPECT_TRUE(std::all_of(found, found + size, [](float g) { return g == 0; })) << block.name;
        continue;
      }
      EXPECT_LT(Distance(found, right, size), kBound) << block.name;
      for (std::size_t i = 0; i < size; ++i) found[i] *= 1.05f;
      EXPECT_GT(Distance(found, right, size), kBound) << block.name;
    }
  }
}

TEST(PolicyNet, UnknownPrecisionIsAnError) {
  PolicyStructure s = SmallBase();
  s.precision = "f16";
  EXPECT_THROW(MakePolicyNet(s, 1), Error);
}

}  // namespace
}  // namespace dexremoe
