#include "nn/mlp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "nn/gradient_check.h"
#include "nn/layers.h"

namespace dexremoe {
namespace {

using Values = std::vector<double>;

Values RandomVector(std::size_t count, std::uint64_t index) {
  Rng rng(13, Stream::kTest, {index});
  Values values(count);
  for (double& value : values) value = rng.Normal();
  return values;
}

TEST(ParamLayout, BlocksFollowOneAnotherAndAreFoundByName) {
  ParamLayout layout;
  const int a = layout.Add("a", 3, 4), b = layout.Add("b", 5, 1);
  EXPECT_EQ(layout.block(a).offset, 0);
  EXPECT_EQ(layout.block(b).offset, 12);
  EXPECT_EQ(layout.size(), 17);
  EXPECT_EQ(layout.Find("b"), b);
  EXPECT_EQ(layout.Find("c"), -1);
}

TEST(ParamLayoutDeathTest, RefusesANameTwice) {
  ParamLayout layout;
  layout.Add("a", 1, 1);
  EXPECT_DEATH(layout.Add("a", 2, 2), "Find");
}

struct MlpCase {
  std::vector<int> widths;
  bool activate_end;
  Activation activation = Activation::kElu;
};

class MlpGradient : public ::testing::TestWithParam<MlpCase> {};

TEST_P(MlpGradient, OfParametersAndInputsMatchesCentralDifferences) {
  ParamLayout layout;
  layout.Add("before", 2, 3);  // offsets must be honoured
  const Mlp mlp(layout, "net", GetParam().widths, GetParam().activate_end, GetParam().activation);
  const int n = 3;
  const Values params = RandomVector(layout.size(), 1), x = RandomVector(n * mlp.inputs(), 2);
  const Values seed = RandomVector(n * mlp.outputs(), 3);
  const auto loss = [&](const Values& p, const Values& at) {
    Values activations(mlp.ActivationSize(n));
    const double* y = mlp.Forward(p.data(), n, at.data(), activations.data());
    double sum = 0;
    for (std::size_t i = 0; i < seed.size(); ++i) sum += seed[i] * y[i];
    return sum;
  };
  Values activations(mlp.ActivationSize(n)), scratch(mlp.ScratchSize(n));
  Values dy = seed, dx(x.size()), grads(layout.size(), 0.0);
  mlp.Forward(params.data(), n, x.data(), activations.data());
  mlp.Backward(params.data(), n, x.data(), activations.data(), dy.data(), dx.data(), grads.data(),
               scratch.data());
  const auto of_params =
      CheckGradient([&](const Values& p) { return loss(p, x); }, params, grads, 1e-6);
  EXPECT_TRUE(of_params.ok) << of_params.Text();
  const auto of_input =
      CheckGradient([&](const Values& at) { return loss(params, at); }, x, dx, 1e-6);
  EXPECT_TRUE(of_input.ok) << of_input.Text();

  // Frozen parameters, no input gradient: the other outputs stay the same.
  Values dy_again = seed, dx_frozen(x.size()), grads_again(layout.size(), 0.0);
  mlp.Backward(params.data(), n, x.data(), activations.data(), dy_again.data(), dx_frozen.data(),
               static_cast<double*>(nullptr), scratch.data());
  EXPECT_EQ(dx_frozen, dx);
  dy_again = seed;
  mlp.Backward(params.data(), n, x.data(), activations.data(), dy_again.data(),
               static_cast<double*>(nullptr), grads_again.data(), scratch.data());
  EXPECT_EQ(grads_again, grads);
}

INSTANTIATE_TEST_SUITE_P(Depths, MlpGradient,
                         ::testing::Values(MlpCase{{4, 3}, false}, MlpCase{{4, 3}, true},
                                           MlpCase{{5, 7, 2}, false}, MlpCase{{5, 7, 2}, true},
                                           MlpCase{{3, 4, 6, 5, 2}, false},
                                           MlpCase{{4, 6, 5, 3}, true, Activation::kRelu}));

TEST(Mlp, InitialWeightsAreUniformWithinTheBoundAndBiasesZero) {
  ParamLayout layout;
  const Mlp mlp(layout, "net", {100, 64, 10}, false);
  std::vector<float> params(layout.size(), 9.0f);
  Rng rng(1, Stream::kInit);
  mlp.Initialize(rng, 0.01, params.data());
  for (int layer = 0; layer < 2; ++layer) {
    const ParamBlock& weight = layout.block(mlp.weight(layer));
    const double bound = (layer == 1 ? 0.01 : 1.0) / std::sqrt(weight.cols);
    double largest = 0, square = 0;
    for (std::int64_t i = 0; i < weight.size(); ++i) {
      const double value = params[weight.offset + i];
      largest = std::max(largest, std::abs(value));
      square += value * value;
    }
    EXPECT_LE(largest, bound);
    EXPECT_GT(largest, 0.95 * bound);
    EXPECT_NEAR(square / weight.size(), bound * bound / 3, 0.15 * bound * bound / 3);
    const ParamBlock& bias = layout.block(mlp.bias(layer));
    for (std::int64_t i = 0; i < bias.size(); ++i) EXPECT_EQ(params[bias.offset + i], 0.0f);
  }
}

TEST(Mlp, GradientMatchesCentralDifferencesOverSeveralRowBlocks) {
  ParamLayout layout;
  const Mlp mlp(layout, "net", {3, 4, 2}, true);
  const int n = 1100;  // more than two of the blocks that rows are processed in
  const Values params = RandomVector(layout.size(), 6), x = RandomVector(n * 3, 7);
  const Values seed = RandomVector(n * 2, 8);
  const auto loss = [&](const Values& p) {
    Values activations(mlp.ActivationSize(n));
    const double* y = mlp.Forward(p.data(), n, x.data(), activations.data());
    double sum = 0;
    for (std::size_t i = 0; i < seed.size(); ++i) sum += seed[i] * y[i];
    return sum;
  };
  Values activations(mlp.ActivationSize(n)), scratch(mlp.ScratchSize(n));
  Values dy = seed, dx(x.size()), grads(layout.size(), 0.0);
  mlp.Forward(params.data(), n, x.data(), activations.data());
  mlp.Backward(params.data(), n, x.data(), activations.data(), dy.data(), dx.data(), grads.data(),
               scratch.data());
  const auto report = CheckGradient(loss, params, grads, 1e-6);
  EXPECT_TRUE(report.ok) << report.Text();
  Values last_dy(seed.end() - 2, seed.end()), last_dx(3);
  mlp.Forward(params.data(), 1, x.data() + 3 * (n - 1), activations.data());
  mlp.Backward(params.data(), 1, x.data() + 3 * (n - 1), activations.data(), last_dy.data(),
               last_dx.data(), static_cast<double*>(nullptr), scratch.data());
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(last_dx[k], dx[3 * (n - 1) + k], 1e-12);
}

TEST(Mlp, NormalizedOnDataHasOutputsOfMeanZeroAndVarianceOne) {
  ParamLayout layout;
  const Mlp mlp(layout, "net", {6, 12, 5}, false, Activation::kRelu);
  std::vector<float> params(layout.size());
  Rng rng(4, Stream::kInit);
  mlp.InitializeHe(rng, params.data());
  const int n = 400;
  const Values values = RandomVector(n * 6, 9);
  std::vector<float> x(values.begin(), values.end());
  for (int i = 0; i < n; ++i) x[6 * i + 2] = 50 + 0.1f * x[6 * i + 2];  // a common offset
  mlp.NormalizeOnData(n, x.data(), params.data());
  std::vector<float> activations(mlp.ActivationSize(n));
  const float* y = mlp.Forward(params.data(), n, x.data(), activations.data());
  for (int j = 0; j < 5; ++j) {
    double mean = 0, square = 0;
    for (int i = 0; i < n; ++i) mean += y[5 * i + j] / n;
    for (int i = 0; i < n; ++i) square += y[5 * i + j] * y[5 * i + j] / n;
    EXPECT_NEAR(mean, 0, 1e-4);
    EXPECT_NEAR(square, 1, 1e-3);
  }
}

TEST(Mlp, FloatMatchesDouble) {
  ParamLayout layout;
  const Mlp mlp(layout, "net", {61, 256, 128, 66}, true);
  std::vector<float> params(layout.size());
  Rng rng(2, Stream::kInit);
  mlp.Initialize(rng, 1.0, params.data());
  const int n = 37;
  const Values x = RandomVector(n * 61, 5);
  const std::vector<float> xf(x.begin(), x.end());
  const Values p(params.begin(), params.end()), rounded(xf.begin(), xf.end());
  Values activations(mlp.ActivationSize(n));
  std::vector<float> activations_f(mlp.ActivationSize(n));
  const double* y = mlp.Forward(p.data(), n, rounded.data(), activations.data());
  const float* yf = mlp.Forward(params.data(), n, xf.data(), activations_f.data());
  for (int i = 0; i < n * 66; ++i) EXPECT_NEAR(yf[i], y[i], 2e-6);
}

}  // namespace
}  // namespace dexremoe
