// A policy's gradients against central differences.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "nn/gradient_check.h"
#include "small_policy.h"

namespace dexremoe {

inline std::vector<double> RandomParams(const Policy<double>& policy) {
  Rng rng(4, Stream::kTest, {2});
  std::vector<double> params(policy.layout().size());
  for (double& p : params) p = 0.4 * rng.Normal();
  return params;
}

// loss = <dmean, mean> + <dvalue, value> + weight times the policy's own losses.
inline double LossOf(const Policy<double>& policy, const Problem<double>& problem,
                     const std::vector<double>& params, double weight = 0) {
  Workspace<double> work;
  std::vector<double> mean(problem.dmean.size()), value(problem.n);
  policy.Forward(params.data(), problem.shapes(), problem.rows(), work, mean.data(), value.data());
  RoutingSums sums;
  policy.Balance(problem.rows(), problem.shapes(), work, weight, sums);
  return weight * sums.loss / static_cast<double>(problem.n) +
         std::inner_product(mean.begin(), mean.end(), problem.dmean.begin(), 0.0) +
         std::inner_product(value.begin(), value.end(), problem.dvalue.begin(), 0.0);
}

// Checks every trainable element; frozen ones must stay untouched. `weight` is that of the policy's
// own losses.
inline void CheckGradients(const PolicyStructure& structure, bool noise = false,
                           double weight = 0) {
  const auto policy = MakePolicy<double>(structure);
  Problem<double> problem(structure, 9, 4);
  if (noise) problem.DrawNoise(*policy);
  const std::vector<double> params = RandomParams(*policy);
  constexpr double kUntouched = 1e30;
  std::vector<double> grads(params.size(), kUntouched);
  std::vector<std::int64_t> dense;
  for (std::size_t b = 0; b < policy->trainable().size(); ++b) {
    const ParamBlock& block = policy->layout().block(static_cast<int>(b));
    if (!policy->trainable()[b]) continue;
    for (std::int64_t i = 0; i < block.size(); ++i) {
      grads[block.offset + i] = 0;
      dense.push_back(block.offset + i);
    }
  }
  Workspace<double> work;
  std::vector<double> mean(problem.dmean.size()), value(problem.n);
  policy->Forward(params.data(), problem.shapes(), problem.rows(), work, mean.data(), value.data());
  RoutingSums sums;
  if (policy->routes()) policy->Balance(problem.rows(), problem.shapes(), work, weight, sums);
  policy->Backward(params.data(), problem.shapes(), problem.rows(), work, problem.dmean.data(),
                   problem.dvalue.data(), grads.data());
  std::vector<double> x, gradient;
  for (const std::int64_t i : dense) {
    x.push_back(params[i]);
    gradient.push_back(grads[i]);
  }
  const auto loss = [&](const std::vector<double>& moved) {
    std::vector<double> all = params;
    for (std::size_t i = 0; i < dense.size(); ++i) all[dense[i]] = moved[i];
    return LossOf(*policy, problem, all, weight);
  };
  const GradientReport report = CheckGradient(loss, x, gradient);
  EXPECT_TRUE(report.ok) << report.Text();
  EXPECT_EQ(static_cast<std::size_t>(std::count(grads.begin(), grads.end(), kUntouched)),
            grads.size() - dense.size());
}

}  // namespace dexremoe
