// The loops of nn/kernels.h on bfloat16.
#include <algorithm>
#include <bit>

#include "nn/kernels.h"
#include "nn/vectorized.h"

namespace dexremoe {
namespace {

// A function of other options than its caller is inlined only when forced.
#define DEX_INLINE [[gnu::always_inline]] inline

DEX_INLINE float Widen(BFloat16 x) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(x.bits) << 16);
}

// To nearest, ties to even: adds just below half of the last kept place, one more when that place
// is odd. A NaN whose payload would carry over, or lie in the lost bits alone, becomes a quiet one.
DEX_INLINE BFloat16 Narrow(float x) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(x);
  const std::uint32_t rounded = bits + 0x7fffu + ((bits >> 16) & 1u);
  const std::uint32_t nan = -static_cast<std::uint32_t>((bits & 0x7fffffffu) > 0x7f800000u);
  const std::uint32_t kept = (rounded & ~nan) | ((bits | 0x400000u) & nan);
  return {static_cast<std::uint16_t>(kept >> 16)};
}

#undef DEX_INLINE

}  // namespace

DEX_VECTORIZED
void EluGradientArray(std::int64_t count, const BFloat16* y, const BFloat16* dy, BFloat16* dx) {
  DEX_INDEPENDENT
  for (std::int64_t i = 0; i < count; ++i) {
    // min(y, 0) without a branch: all bits where the sign is set, else none.
    const std::uint16_t sign = static_cast<std::uint16_t>(-(y[i].bits >> 15));
    const BFloat16 below = {static_cast<std::uint16_t>(y[i].bits & sign)};
    dx[i] = Narrow(Widen(dy[i]) * (1.0f + Widen(below)));
  }
}

DEX_VECTORIZED
void ReluGradientArray(std::int64_t count, const BFloat16* y, const BFloat16* dy, BFloat16* dx) {
  DEX_INDEPENDENT
  for (std::int64_t i = 0; i < count; ++i) {
    const float gradient = Widen(dy[i]);
    dx[i] = Narrow(Widen(y[i]) > 0.0f ? gradient : 0.0f);
  }
}

DEX_VECTORIZED
void AddTo(std::int64_t count, const BFloat16* x, float* sum) {
  DEX_INDEPENDENT
  for (std::int64_t i = 0; i < count; ++i) sum[i] += Widen(x[i]);
}

DEX_VECTORIZED
void Cast(std::int64_t count, const float* x, BFloat16* y) {
  DEX_INDEPENDENT
  for (std::int64_t i = 0; i < count; ++i) y[i] = Narrow(x[i]);
}

DEX_VECTORIZED
void Cast(std::int64_t count, const BFloat16* x, float* y) {
  DEX_INDEPENDENT
  for (std::int64_t i = 0; i < count; ++i) y[i] = Widen(x[i]);
}

void Cast(std::int64_t count, const BFloat16* x, BFloat16* y) { std::copy_n(x, count, y); }
void Cast(std::int64_t count, const float* x, float* y) { std::copy_n(x, count, y); }
void Cast(std::int64_t count, const float* x, double* y) { std::copy_n(x, count, y); }
void Cast(std::int64_t count, const double* x, double* y) { std::copy_n(x, count, y); }

}  // namespace dexremoe
