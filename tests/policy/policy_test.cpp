// Policies: gradients against central differences, frozen blocks, and what a mixture must equal.
#include "policy/policy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "gradient_of_policy.h"
#include "policy/shape_table.h"
#include "small_policy.h"

namespace dexremoe {
namespace {

TEST(Policy, GradientsOfTheBaseMatchCentralDifferences) { CheckGradients(SmallBase()); }

TEST(Policy, GradientsMatchCentralDifferencesWhateverIsSeen) {
  PolicyStructure s = SmallBase();
  s.see_category = false;
  CheckGradients(s);
  s.see_cloud = false;
  s.phys_seen = {0, 2, 3};
  CheckGradients(s);
}

PolicyStructure SmallOnPoints() {
  PolicyStructure s = SmallBase();
  s.cloud_points = 5;
  s.feature_size = FeatureSize(s.cloud_points);
  return s;
}

TEST(Policy, GradientsThroughPointsMatchCentralDifferences) {
  CheckGradients(SmallOnPoints());
  PolicyStructure mixture = SmallMixture("cloud");
  mixture.cloud_points = 5;
  mixture.feature_size = FeatureSize(5);
  CheckGradients(mixture);
}

TEST(Policy, TheOrderOfPointsAndRepeatedPointsDoNotMatter) {
  const PolicyStructure s = SmallOnPoints();
  const auto policy = MakePolicy<double>(s);
  Problem<double> problem(s, 6, 4);
  const std::vector<double> params = RandomParams(*policy);
  double* object = problem.feature.data() + 15;
  std::copy_n(object, 3, object + 12);  // the first of five points is also the last
  const double before = LossOf(*policy, problem, params);
  std::swap_ranges(object, object + 3, object + 6);
  EXPECT_EQ(LossOf(*policy, problem, params), before);
  std::copy_n(object + 3, 3, object + 12);  // now the second is
  EXPECT_EQ(LossOf(*policy, problem, params), before);
  for (int i = 0; i < 15; ++i) object[i] += 1;
  EXPECT_NE(LossOf(*policy, problem, params), before);
}

// Changes what the policy must not see; nothing else may change with it.
TEST(Policy, HiddenInputsDoNotMatter) {
  PolicyStructure s = SmallBase();
  s.see_cloud = s.see_category = false;
  s.phys_seen = {0, 3};
  const auto policy = MakePolicy<double>(s);
  Problem<double> problem(s, 6, 4);
  const std::vector<double> params = RandomParams(*policy);
  const double before = LossOf(*policy, problem, params);
  for (double& p : problem.feature) p += 1;
  std::reverse(problem.category.begin(), problem.category.end());
  for (int r = 0; r < 6; ++r) problem.phys[r * 4 + 1] = problem.phys[r * 4 + 2] = 7;
  EXPECT_EQ(LossOf(*policy, problem, params), before);
  problem.phys[3] += 1;
  EXPECT_NE(LossOf(*policy, problem, params), before);
  EXPECT_EQ(policy->layout().Find("encoder/cloud/0/weight"), -1);
}

TEST(Policy, GradientsOfAnExpertMatchCentralDifferencesAndSpareTheEncoders) {
  PolicyStructure s = SmallBase();
  s.train_encoders = false;
  CheckGradients(s);
  const auto policy = MakePolicy<double>(s);
  for (std::size_t b = 0; b < policy->trainable().size(); ++b)
    EXPECT_EQ(policy->trainable()[b] == 0,
              policy->layout().block(static_cast<int>(b)).name.starts_with("encoder/"));
}

TEST(Policy, GradientsOfTheMixtureMatchCentralDifferences) {
  for (const char* input : {"full", "cloud", "category"}) {
    SCOPED_TRACE(input);
    CheckGradients(SmallMixture(input));
  }
  PolicyStructure uniform = SmallMixture("full");
  uniform.gate_uniform = true;
  CheckGradients(uniform);
}

TEST(Policy, MixtureTrainsNothingButGateAndValueHead) {
  const auto policy = MakePolicy<float>(SmallMixture("full"));
  for (std::size_t b = 0; b < policy->trainable().size(); ++b) {
    const std::string& name = policy->layout().block(static_cast<int>(b)).name;
    EXPECT_EQ(policy->trainable()[b] != 0, name.starts_with("gate/") || name.starts_with("value/"))
        << name;
  }
}

TEST(Policy, BaseHasThePapersNumberOfParameters) {
  const auto policy = MakePolicy<float>(PolicyStructure());
  const auto linear = [](std::int64_t c, std::int64_t k) { return (c + 1) * k; };
  const std::int64_t cloud = linear(100, 32) + 2 * linear(32, 32);
  const std::int64_t extrinsics = linear(61, 256) + linear(256, 128) + linear(128, 66);
  const std::int64_t actor = linear(132, 512) + linear(512, 512) + linear(512, 11) + linear(512, 1);
  EXPECT_EQ(policy->layout().size(), cloud + extrinsics + actor + 11);
}

TEST(Policy, FrozenFeaturesChangeNothing) {
  PolicyStructure expert = SmallBase();
  expert.train_encoders = false;
  for (const PolicyStructure& s : {expert, SmallMixture("full")}) {
    const auto policy = MakePolicy<double>(s);
    const Problem<double> problem(s, 7, 3);
    const std::vector<double> params = RandomParams(*policy);
    Workspace<double> work;
    std::vector<double> frozen(problem.n * policy->frozen_size());
    std::vector<double> mean(problem.dmean.size()), value(problem.n), mean2 = mean, value2 = value;
    policy->Forward(params.data(), problem.shapes(), problem.rows(), work, mean.data(),
                    value.data());
    policy->Freeze(params.data(), problem.shapes(), problem.rows(), work, frozen.data());
    PolicyRows<double> rows = problem.rows();
    rows.frozen = frozen.data();
    policy->Forward(params.data(), problem.shapes(), rows, work, mean2.data(), value2.data());
    EXPECT_EQ(mean, mean2);
    EXPECT_EQ(value, value2);
  }
}

TEST(Policy, ObjectsOfTheTableCanBeRelabelled) {
  const PolicyStructure s = SmallBase();
  const auto policy = MakePolicy<double>(s);
  Problem<double> problem(s, 8, 4);
  const std::vector<double> params = RandomParams(*policy);
  const double before = LossOf(*policy, problem, params);
  // Reverse the table and the labels with it.
  const Problem<double> old = problem;
  for (int k = 0; k < 4; ++k) {
    std::copy_n(old.feature.begin() + k * 7, 7, problem.feature.begin() + (3 - k) * 7);
    std::copy_n(old.category.begin() + k * 6, 6, problem.category.begin() + (3 - k) * 6);
  }
  for (int& object : problem.object) object = 3 - object;
  EXPECT_NEAR(LossOf(*policy, problem, params), before, 1e-12);
}

// Means of expert i alone, read from the mixture's frozen features.
TEST(Policy, MixtureIsTheWeightedSumOfItsExperts) {
  const PolicyStructure s = SmallMixture("full");
  const auto policy = MakePolicy<double>(s);
  const Problem<double> problem(s, 6, 4);
  const std::vector<double> params = RandomParams(*policy);
  Workspace<double> work;
  std::vector<double> frozen(problem.n * policy->frozen_size()), weights(4 * 3);
  std::vector<double> mean(problem.dmean.size()), value(problem.n);
  policy->Freeze(params.data(), problem.shapes(), problem.rows(), work, frozen.data());
  policy->GateWeights(params.data(), problem.shapes(), work, weights.data());
  policy->Forward(params.data(), problem.shapes(), problem.rows(), work, mean.data(), value.data());
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(weights[3 * k] + weights[3 * k + 1] + weights[3 * k + 2], 1, 1e-12);
    for (int i = 0; i < 3; ++i) EXPECT_GT(weights[3 * k + i], 0);
  }
  for (int r = 0; r < 6; ++r)
    for (int a = 0; a < 3; ++a) {
      double expected = 0;
      for (int i = 0; i < 3; ++i)
        expected +=
            weights[3 * problem.object[r] + i] * frozen[r * policy->frozen_size() + i * 3 + a];
      EXPECT_NEAR(mean[r * 3 + a], expected, 1e-12);
    }
}

TEST(Policy, UniformMixtureWeighsAllExpertsAlike) {
  PolicyStructure s = SmallMixture("full");
  s.gate_uniform = true;
  const auto policy = MakePolicy<double>(s);
  const Problem<double> problem(s, 2, 4);
  const std::vector<double> params = RandomParams(*policy);
  Workspace<double> work;
  std::vector<double> weights(4 * 3);
  policy->GateWeights(params.data(), problem.shapes(), work, weights.data());
  for (const double w : weights) EXPECT_DOUBLE_EQ(w, 1.0 / 3);
}

TEST(Policy, GateSeesWhatItsInputSays) {
  // Two objects of one category with other clouds; two of one cloud with other categories.
  for (const char* input : {"cloud", "category"}) {
    const PolicyStructure s = SmallMixture(input);
    const auto policy = MakePolicy<double>(s);
    Problem<double> problem(s, 1, 3);
    std::fill(problem.category.begin(), problem.category.end(), 0);
    problem.category[0] = problem.category[6] = problem.category[2 * 6 + 1] = 1;
    std::copy_n(problem.feature.begin(), 7, problem.feature.begin() + 2 * 7);
    const std::vector<double> params = RandomParams(*policy);
    Workspace<double> work;
    std::vector<double> w(3 * 3);
    policy->GateWeights(params.data(), problem.shapes(), work, w.data());
    const bool same_category_same_weights = w[0] == w[3], same_cloud_same_weights = w[0] == w[6];
    EXPECT_EQ(same_category_same_weights, std::string(input) == "category");
    EXPECT_EQ(same_cloud_same_weights, std::string(input) == "cloud");
  }
}

TEST(Policy, FreshGateIsNearTheUniformAverage) {
  const PolicyStructure s = SmallMixture("full");
  const auto policy = MakePolicy<float>(s);
  const Problem<float> problem(s, 1, 4);
  std::vector<float> params(policy->layout().size());
  policy->Initialize(7, -1, 1, params.data());
  Workspace<float> work;
  std::vector<float> weights(4 * 3);
  policy->GateWeights(params.data(), problem.shapes(), work, weights.data());
  for (const float w : weights) EXPECT_NEAR(w, 1.0 / 3, 0.02);
  const ParamBlock& spread = policy->layout().block(policy->log_std_block());
  for (int a = 0; a < 3; ++a) EXPECT_EQ(params[spread.offset + a], -1);
}

TEST(Policy, UnknownKindsAndEmptyLayersAreErrors) {
  PolicyStructure s = SmallBase();
  s.kind = "oracle";
  EXPECT_THROW(MakePolicy<float>(s), Error);
  s = SmallBase();
  s.hidden = {};
  EXPECT_THROW(MakePolicy<float>(s), Error);
  s = SmallMixture("colour");
  EXPECT_THROW(MakePolicy<float>(s), Error);
}

TEST(ShapeTable, ObjectWithoutDescriptorIsNamed) {
  TaskObject object;
  object.name = "teapot";
  try {
    MakeShapeTable({object});
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "object teapot: descriptor: expected 100 values, found 0");
  }
}

}  // namespace
}  // namespace dexremoe
