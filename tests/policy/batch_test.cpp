// What a policy does with a row has nothing to do with the other rows of a batch, to the last bit:
// an episode recorded alone is the episode that was evaluated among others.
#include <gtest/gtest.h>

#include <algorithm>

#include "small_policy.h"

namespace dexremoe {
namespace {

class Batch : public testing::TestWithParam<const char*> {};

// Of the usual sizes, so that products take the ways they take in earnest.
PolicyStructure Usual(const std::string& kind) {
  PolicyStructure s;
  s.kind = kind;
  s.hidden = {256, 256};
  s.experts = kind == "actor_critic" ? 0 : 4;
  s.top_k = 2;
  s.ranks = {16, 32, 48, 64};
  s.category_rank = 40;
  return s;
}

TEST_P(Batch, ARowsActionsDoNotDependOnItsNeighbours) {
  const auto policy = MakePolicy<float>(Usual(GetParam()));
  std::vector<float> params(policy->layout().size());
  policy->Initialize(1, 0, 1, params.data());
  Problem<float> problem(policy->structure(), 300, 6);
  const int actions = policy->structure().num_actions;
  Workspace<float> work;
  std::vector<float> mean(problem.n * actions), value(problem.n);
  policy->Forward(params.data(), problem.shapes(), problem.rows(), work, mean.data(), value.data());
  for (const std::int64_t count : {1, 2, 3, 4, 7, 64, 255}) {
    const std::int64_t first = 11;
    PolicyRows<float> some = problem.rows();
    some.n = count;
    some.obs += first * policy->structure().obs_size;
    some.phys += first * policy->structure().phys_size;
    some.object += first;
    std::vector<float> alone(count * actions), alone_value(count);
    policy->Forward(params.data(), problem.shapes(), some, work, alone.data(), alone_value.data());
    EXPECT_TRUE(std::equal(alone.begin(), alone.end(), mean.begin() + first * actions)) << count;
    EXPECT_TRUE(std::equal(alone_value.begin(), alone_value.end(), value.begin() + first)) << count;
  }
}

INSTANTIATE_TEST_SUITE_P(EveryKind, Batch,
                         testing::Values("actor_critic", "sparse_moe", "switch_moe", "mmoe",
                                         "mlore"));

}  // namespace
}  // namespace dexremoe
