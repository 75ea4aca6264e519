// bfloat16: rounding, and layers against float within the bounds that its 8 bits allow.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <thread>

#include "base/error.h"
#include "base/thread_pool.h"
#include "nn/bf16_product.h"
#include "nn/kernels.h"
#include "nn/mlp.h"
#include "nn/precision.h"

namespace dexremoe {
namespace {

constexpr double kUnit = 1.0 / 256;  // the largest relative error of one rounding

std::vector<float> Draw(std::size_t count, std::uint64_t index) {
  Rng rng(17, Stream::kTest, {index});
  std::vector<float> values(count);
  for (float& value : values) value = static_cast<float>(rng.Normal());
  return values;
}

std::vector<BFloat16> Rounded(const std::vector<float>& x) {
  std::vector<BFloat16> y(x.size());
  Cast(static_cast<std::int64_t>(x.size()), x.data(), y.data());
  return y;
}

std::vector<float> Widened(const std::vector<BFloat16>& x) {
  std::vector<float> y(x.size());
  Cast(static_cast<std::int64_t>(x.size()), x.data(), y.data());
  return y;
}

float RoundTrip(float x) { return Widened(Rounded({x}))[0]; }

// |a - b| / |b|, Euclidean.
double Distance(const std::vector<float>& a, const std::vector<float>& b) {
  double square = 0, scale = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    square += std::pow(static_cast<double>(a[i]) - b[i], 2);
    scale += std::pow(static_cast<double>(b[i]), 2);
  }
  return std::sqrt(square / scale);
}

TEST(BFloat16, RoundsToTheNearestWithTiesToEven) {
  EXPECT_EQ(RoundTrip(1 + 1.0f / 128), 1 + 1.0f / 128);  // neighbours are 1/128 apart from 1 on
  EXPECT_EQ(RoundTrip(1 + 1.0f / 256), 1.0f);
  EXPECT_EQ(RoundTrip(1 + 3.0f / 256), 1 + 2.0f / 128);
  EXPECT_EQ(RoundTrip(1 + 1.1f / 256), 1 + 1.0f / 128);
  EXPECT_EQ(RoundTrip(-1 - 1.1f / 256), -1 - 1.0f / 128);
  EXPECT_TRUE(std::signbit(RoundTrip(-0.0f)));
  for (const float x : Draw(1000, 1)) EXPECT_LE(std::abs(RoundTrip(x) - x), kUnit * std::abs(x));
}

TEST(BFloat16, KeepsInfinityAndEveryKindOfNan) {
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(RoundTrip(-infinity), -infinity);
  EXPECT_EQ(RoundTrip(std::numeric_limits<float>::max()), infinity);
  for (const std::uint32_t bits : {0x7f800001u, 0x7fffffffu, 0xffffffffu, 0x7fc00000u})
    EXPECT_TRUE(std::isnan(RoundTrip(std::bit_cast<float>(bits)))) << bits;
}

TEST(BFloat16, WideningAndRoundingAgainChangesNoBit) {
  for (std::uint32_t bits = 0; bits < 0x7f80u; ++bits) {
    const BFloat16 x = {static_cast<std::uint16_t>(bits)};
    ASSERT_EQ(Rounded(Widened({x}))[0].bits, bits);
  }
}

TEST(BFloat16, ActivationGradientsAreTheFloatOnesRounded) {
  const auto y = Rounded(Draw(1003, 2)), dy = Rounded(Draw(1003, 3));
  const auto wide_y = Widened(y), wide_dy = Widened(dy);
  std::vector<BFloat16> dx(1003);
  std::vector<float> expected(1003);
  EluGradientArray(1003, y.data(), dy.data(), dx.data());
  EluGradientArray(1003, wide_y.data(), wide_dy.data(), expected.data());
  EXPECT_EQ(Widened(dx), Widened(Rounded(expected)));
  ReluGradientArray(1003, y.data(), dy.data(), dx.data());
  ReluGradientArray(1003, wide_y.data(), wide_dy.data(), expected.data());
  EXPECT_EQ(Widened(dx), Widened(Rounded(expected)));
}

TEST(BFloat16, EluGradientOfNanIsNanInPairsAndAtTheEnd) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto y = Rounded({1, nan, -nan, -0.5f, nan}), dy = Rounded({1, 1, 1, 1, 1});
  std::vector<BFloat16> dx(5);
  EluGradientArray(5, y.data(), dy.data(), dx.data());
  const auto wide = Widened(dx);
  for (const int i : {1, 2, 4}) EXPECT_TRUE(std::isnan(wide[i])) << i;
  EXPECT_EQ(wide[0], 1);
  EXPECT_EQ(wide[3], 0.5f);
}

TEST(Precision, AutoIsWhatTheProcessorHasAndUnknownWordsAreErrors) {
  EXPECT_EQ(ResolvePrecision("auto"), HasNativeBfloat16() ? "bf16" : "f32");
  EXPECT_EQ(ResolvePrecision("f32"), "f32");
  EXPECT_THROW(ResolvePrecision("f16"), Error);
  if (HasNativeBfloat16())
    EXPECT_EQ(ResolvePrecision("bf16"), "bf16");
  else
    EXPECT_THROW(ResolvePrecision("bf16"), Error);
}

// A network, its inputs and what passes through it, stored as T.
template <typename T>
struct Pass {
  Pass(const Mlp& mlp, std::int64_t rows, const std::vector<T>& params, const std::vector<T>& x,
       std::vector<T> dy, std::int64_t first = 0)
      : activations(mlp.ActivationSize(rows)),
        dx(rows * (mlp.inputs() - first)),
        scratch(mlp.ScratchSize(rows)),
        grads(params.size()) {
    const T* out = mlp.Forward(params.data(), rows, x.data(), activations.data());
    y.assign(out, out + rows * mlp.outputs());
    mlp.Backward(params.data(), rows, x.data(), activations.data(), dy.data(), dx.data(),
                 grads.data(), scratch.data(), first);
  }
  std::vector<T> activations, y, dx, scratch;
  std::vector<Wide<T>> grads;
};

class Bf16Mlp : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!HasNativeBfloat16()) GTEST_SKIP() << "no bfloat16 on this processor";
    params_.resize(layout_.size());
    Rng rng(2, Stream::kInit);
    mlp_.Initialize(rng, 1.0, params_.data());
  }
  Pass<float> Reference() const { return {mlp_, kRows, params_, x_, dy_, kFirst}; }
  Pass<BFloat16> Stored() const {
    return {mlp_, kRows, Rounded(params_), Rounded(x_), Rounded(dy_), kFirst};
  }

  static constexpr int kRows = 700, kFirst = 23;  // two row blocks; a slice of the inputs
  ParamLayout layout_;
  const Mlp mlp_{layout_, "net", {61, 256, 128, 66}, false};
  std::vector<float> params_, x_ = Draw(kRows * 61, 4), dy_ = Draw(kRows * 66, 5);
};

// Every layer rounds its weights, its inputs and its result; the errors are random, so a pass of
// three layers stays within three roundings.
TEST_F(Bf16Mlp, StaysWithinThreeRoundingsOfFloat) {
  const Pass<float> reference = Reference();
  const Pass<BFloat16> stored = Stored();
  EXPECT_LT(Distance(Widened(stored.y), reference.y), 3 * kUnit);
  EXPECT_LT(Distance(Widened(stored.dx), reference.dx), 3 * kUnit);
  EXPECT_LT(Distance(stored.grads, reference.grads), 3 * kUnit);
}

// What the bound is worth: any block's gradient 3 % too small lies outside of it.
TEST_F(Bf16Mlp, TheBoundRejectsAWrongGradient) {
  const Pass<float> reference = Reference();
  for (const ParamBlock& block : layout_.blocks()) {
    const auto part = [&](const std::vector<float>& all) {
      return std::vector<float>(all.begin() + block.offset,
                                all.begin() + block.offset + block.size());
    };
    const auto right = part(reference.grads);
    auto found = part(Stored().grads);
    EXPECT_LT(Distance(found, right), 3 * kUnit) << block.name;
    for (float& value : found) value *= 0.97f;
    EXPECT_GT(Distance(found, right), 3 * kUnit) << block.name;
  }
}

TEST_F(Bf16Mlp, BitsDoNotDependOnTheNumberOfWorkersAndNoThreadsAreAdded) {
  const Pass<BFloat16> reference = Stored();
  const auto same = [](const auto& a, const auto& b) {
    return std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
  };
  const auto threads = [] {
    return std::distance(std::filesystem::directory_iterator("/proc/self/task"), {});
  };
  const auto before = threads();
  ThreadPool pool(3);
  std::vector<int> equal(8);
  pool.ParallelFor(8, [&](int chunk, int) {
    const Pass<BFloat16> pass = Stored();
    equal[chunk] = same(pass.y, reference.y) && same(pass.dx, reference.dx) &&
                   same(pass.grads, reference.grads);
  });
  EXPECT_EQ(equal, std::vector<int>(8, 1));
  EXPECT_EQ(threads(), before + 2);
}

// 300 counts of rows, of nine powers of two. Every layer has three products: forward, gradient of
// inputs, gradient of weights. The thread is new: products are counted, and kept, by thread.
TEST_F(Bf16Mlp, ManyCountsOfRowsShareFewProducts) {
  const auto params = Rounded(params_), x = Rounded(x_), dy = Rounded(dy_);
  std::size_t products = 0;
  std::thread([&] {
    for (int rows = 1; rows <= 300; ++rows) Pass<BFloat16>(mlp_, rows, params, x, dy, kFirst);
    products = NumProducts();
  }).join();
  EXPECT_LE(products, 9u * 3 * mlp_.layers());
}

// A row's result may round otherwise in another count of rows, but is the same row.
TEST_F(Bf16Mlp, RowsOfAnyCountAreThoseOfALargerOne) {
  const auto params = Rounded(params_), x = Rounded(x_), dy = Rounded(dy_);
  const Pass<BFloat16> all = Stored();
  for (const int rows : {1, 7, 300, 511, 513}) {
    const Pass<BFloat16> some(mlp_, rows, params, x, dy, kFirst);
    const auto head = [&](const std::vector<BFloat16>& of, std::size_t count) {
      return Widened({of.begin(), of.begin() + count});
    };
    EXPECT_LT(Distance(Widened(some.y), head(all.y, some.y.size())), kUnit) << rows;
    EXPECT_LT(Distance(Widened(some.dx), head(all.dx, some.dx.size())), kUnit) << rows;
  }
}

TEST_F(Bf16Mlp, BackwardAddsToTheGradients) {
  Pass<BFloat16> pass = Stored();
  const std::vector<float> once = pass.grads;
  std::vector<BFloat16> dy = Rounded(dy_);
  const auto params = Rounded(params_), x = Rounded(x_);
  mlp_.Backward(params.data(), kRows, x.data(), pass.activations.data(), dy.data(),
                static_cast<BFloat16*>(nullptr), pass.grads.data(), pass.scratch.data());
  for (std::size_t i = 0; i < once.size(); ++i)
    EXPECT_NEAR(pass.grads[i], 2 * once[i], 1e-3 * (1 + std::abs(once[i])));
}

}  // namespace
}  // namespace dexremoe
