// Gradients of every layer against central differences in double; the fast ELU against the exact
// one.
#include "nn/layers.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <vector>

#include "base/random.h"
#include "nn/gradient_check.h"
#include "nn/mlp.h"

namespace dexremoe {
namespace {

using Values = std::vector<double>;

Values RandomVector(std::size_t count, std::uint64_t index) {
  Rng rng(11, Stream::kTest, {index});
  Values values(count);
  for (double& value : values) value = rng.Normal();
  return values;
}

double Dot(const Values& a, const Values& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

// Checks d(seed . f(x))/dx.
void ExpectGradient(const std::function<Values(const Values&)>& f, const Values& seed,
                    const Values& x, const Values& gradient) {
  const auto report =
      CheckGradient([&](const Values& at) { return Dot(seed, f(at)); }, x, gradient, 1e-7);
  EXPECT_TRUE(report.ok) << report.Text();
}

TEST(Layers, LinearGradientsMatchCentralDifferences) {
  const int n = 5, c = 4, k = 3;
  const Values x = RandomVector(n * c, 1), w = RandomVector(k * c, 2), b = RandomVector(k, 3);
  const Values dy = RandomVector(n * k, 4);
  Values dx(n * c), dw(k * c, 0.0), db(k, 0.0);
  LinearBackward<double>(n, c, k, x.data(), w.data(), dy.data(), dx.data(), dw.data(), db.data());
  const auto forward = [&](const Values& x, const Values& w, const Values& b) {
    Values y(n * k);
    LinearForward<double>(n, c, k, x.data(), w.data(), b.data(), y.data());
    return y;
  };
  ExpectGradient([&](const Values& at) { return forward(at, w, b); }, dy, x, dx);
  ExpectGradient([&](const Values& at) { return forward(x, at, b); }, dy, w, dw);
  ExpectGradient([&](const Values& at) { return forward(x, w, at); }, dy, b, db);
}

TEST(Layers, LinearBackwardAddsToParameterGradientsAndSkipsNullOnes) {
  const int n = 2, c = 3, k = 2;
  const Values x = RandomVector(n * c, 1), w = RandomVector(k * c, 2), dy = RandomVector(n * k, 4);
  Values dw(k * c, 0.0), db(k, 0.0), dx(n * c), dx_alone(n * c);
  LinearBackward<double>(n, c, k, x.data(), w.data(), dy.data(), dx.data(), dw.data(), db.data());
  Values dw2 = dw, db2 = db;
  LinearBackward<double>(n, c, k, x.data(), w.data(), dy.data(), nullptr, dw2.data(), db2.data());
  for (int i = 0; i < k * c; ++i) EXPECT_DOUBLE_EQ(dw2[i], 2 * dw[i]);
  for (int i = 0; i < k; ++i) EXPECT_DOUBLE_EQ(db2[i], 2 * db[i]);
  LinearBackward<double>(n, c, k, x.data(), w.data(), dy.data(), dx_alone.data(), nullptr, nullptr);
  EXPECT_EQ(dx, dx_alone);
}

using Forward = void (*)(std::int64_t, const double*, double*);
using Backward = void (*)(std::int64_t, const double*, const double*, double*);

void ExpectElementwiseGradient(Forward forward, Backward backward) {
  const Values x = RandomVector(40, 5), dy = RandomVector(40, 6);
  const auto f = [&](const Values& at) {
    Values y(at.size());
    forward(static_cast<std::int64_t>(at.size()), at.data(), y.data());
    return y;
  };
  const Values y = f(x);
  Values dx(x.size());
  backward(40, y.data(), dy.data(), dx.data());
  ExpectGradient(f, dy, x, dx);
  Values in_place = dy;
  backward(40, y.data(), in_place.data(), in_place.data());
  EXPECT_EQ(in_place, dx);
}

TEST(Layers, EluGradientMatchesCentralDifferences) {
  ExpectElementwiseGradient(EluForward<double>, EluBackward<double>);
}

TEST(Layers, ReluGradientMatchesCentralDifferences) {
  ExpectElementwiseGradient(ReluForward<double>, ReluBackward<double>);
}

TEST(Layers, SoftmaxRowsSumToOneAndGradientMatchesCentralDifferences) {
  const int n = 4, k = 6;
  Values x = RandomVector(n * k, 7);
  x[3] += 40;  // a row that would overflow nothing but saturates
  const Values dy = RandomVector(n * k, 8);
  const auto f = [&](const Values& at) {
    Values y(n * k);
    SoftmaxForward<double>(n, k, at.data(), y.data());
    return y;
  };
  const Values y = f(x);
  for (int i = 0; i < n; ++i) {
    double sum = 0;
    for (int j = 0; j < k; ++j) sum += y[i * k + j];
    EXPECT_NEAR(sum, 1, 1e-14);
  }
  Values dx(n * k);
  SoftmaxBackward<double>(n, k, y.data(), dy.data(), dx.data());
  ExpectGradient(f, dy, x, dx);
}

TEST(Layers, SoftmaxOfHugeInputsIsFinite) {
  const float x[3] = {3e38f, -3e38f, 3e38f};
  float y[3];
  SoftmaxForward<float>(1, 3, x, y);
  EXPECT_FLOAT_EQ(y[0], 0.5f);
  EXPECT_FLOAT_EQ(y[1], 0.0f);
}

void ExpectFloatLayersMatchDouble(Forward exact, Backward exact_backward,
                                  void (*fast)(std::int64_t, const float*, float*),
                                  void (*fast_backward)(std::int64_t, const float*, const float*,
                                                        float*)) {
  const Values x = RandomVector(1003, 9), dy = RandomVector(1003, 10);
  const std::vector<float> xf(x.begin(), x.end()), dyf(dy.begin(), dy.end());
  Values y(x.size()), dx(x.size());
  std::vector<float> yf(x.size()), dxf(x.size());
  exact(1003, x.data(), y.data());
  exact_backward(1003, y.data(), dy.data(), dx.data());
  fast(1003, xf.data(), yf.data());
  fast_backward(1003, yf.data(), dyf.data(), dxf.data());
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_NEAR(yf[i], y[i], 1e-6);
    EXPECT_NEAR(dxf[i], dx[i], 2e-6);
  }
}

TEST(Layers, FloatActivationsMatchTheDoubleOnes) {
  ExpectFloatLayersMatchDouble(EluForward<double>, EluBackward<double>, EluForward<float>,
                               EluBackward<float>);
  ExpectFloatLayersMatchDouble(ReluForward<double>, ReluBackward<double>, ReluForward<float>,
                               ReluBackward<float>);
}

// The bound that nn/kernels.h states, on a dense sweep of negative floats over all magnitudes.
TEST(Elu, RelativeErrorIsBelowTwoTenMillionths) {
  std::vector<float> x;
  for (std::uint32_t bits = 0x00800000u; bits < 0x42c80000u; bits += 977)  // 1e-38 .. 100
    x.push_back(-std::bit_cast<float>(bits));
  std::vector<float> y(x.size());
  EluForward<float>(static_cast<std::int64_t>(x.size()), x.data(), y.data());
  double worst = 0;
  float where = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double exact = std::expm1(static_cast<double>(x[i]));
    const double error = std::abs(y[i] - exact) / std::abs(exact);
    if (error > worst) {
      worst = error;
      where = x[i];
    }
  }
  EXPECT_LT(worst, 2e-7) << "at " << where;
  RecordProperty("worst_relative_error", std::to_string(worst));
}

TEST(Elu, IsMonotoneAndContinuousAcrossItsPieces) {
  std::vector<float> x, y;
  for (int i = -200000; i <= 20000; ++i) x.push_back(static_cast<float>(i) * 1e-4f);
  y.resize(x.size());
  EluForward<float>(static_cast<std::int64_t>(x.size()), x.data(), y.data());
  for (std::size_t i = 1; i < y.size(); ++i) ASSERT_GE(y[i], y[i - 1]) << x[i];
}

TEST(Elu, SpecialValues) {
  const float infinity = std::numeric_limits<float>::infinity();
  const float x[6] = {0.0f, -0.0f, infinity, -infinity, NAN, -1e30f};
  float y[6];
  EluForward<float>(6, x, y);
  EXPECT_EQ(y[0], 0.0f);
  EXPECT_EQ(y[1], 0.0f);
  EXPECT_EQ(y[2], infinity);
  EXPECT_EQ(y[3], -1.0f);
  EXPECT_TRUE(std::isnan(y[4]));
  EXPECT_EQ(y[5], -1.0f);
}

// Vector bodies and scalar tails must agree: a sample's result may not depend on its row.
TEST(Elu, BitsDoNotDependOnThePositionInTheArray) {
  const Values values = RandomVector(67, 12);
  const std::vector<float> x(values.begin(), values.end());
  std::vector<float> y(x.size());
  EluForward<float>(static_cast<std::int64_t>(x.size()), x.data(), y.data());
  for (std::size_t i = 0; i < x.size(); ++i) {
    float alone;
    EluForward<float>(1, &x[i], &alone);
    EXPECT_EQ(std::bit_cast<std::uint32_t>(alone), std::bit_cast<std::uint32_t>(y[i])) << x[i];
  }
}

}  // namespace
}  // namespace dexremoe
