// The loops of nn/kernels.h on bfloat16.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

#include "nn/kernels.h"
#include "nn/vectorized.h"

namespace dexremoe {
namespace {

// A function of other options than its caller is inlined only when forced.
#define DEX_INLINE [[gnu::always_inline]] inline

DEX_INLINE float Widen(BFloat16 x) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(x.bits) << 16);
}

// The upper half of the result: x to nearest, ties to even. Adds just below half of the last kept
// place, one more when that place is odd. A NaN whose payload would carry over, or lie in the lost
// bits alone, becomes a quiet one.
DEX_INLINE std::uint32_t Round(float x) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(x);
  const std::uint32_t rounded = bits + 0x7fffu + ((bits >> 16) & 1u);
  return (bits & 0x7fffffffu) > 0x7f800000u ? bits | 0x400000u : rounded;
}

DEX_INLINE BFloat16 Narrow(float x) { return {static_cast<std::uint16_t>(Round(x) >> 16)}; }

// Two neighbours in one word of 32 bits, the first in its lower half: loops over words need no
// shuffles between lanes of different width, and take less than half of the time.
struct Two {
  float first, second;
};
DEX_INLINE Two Load(const BFloat16* x) {
  std::uint32_t word;
  std::memcpy(&word, x, sizeof(word));
  return {std::bit_cast<float>(word << 16), std::bit_cast<float>(word & 0xffff0000u)};
}
DEX_INLINE void Store(float first, float second, BFloat16* y) {
  const std::uint32_t word = (Round(first) >> 16) | (Round(second) & 0xffff0000u);
  std::memcpy(static_cast<void*>(y), &word, sizeof(word));
}

// NaN stays NaN.
DEX_INLINE float EluGradient(float y, float dy) { return dy * (1.0f + (y > 0.0f ? 0.0f : y)); }
DEX_INLINE float ReluGradient(float y, float dy) { return y > 0.0f ? dy : 0.0f; }

#undef DEX_INLINE

}  // namespace

DEX_VECTORIZED
void EluGradientArray(std::int64_t count, const BFloat16* y, const BFloat16* dy, BFloat16* dx) {
  DEX_INDEPENDENT
  for (std::int64_t i = 0; i < count / 2 * 2; i += 2) {
    const Two a = Load(y + i), b = Load(dy + i);
    Store(EluGradient(a.first, b.first), EluGradient(a.second, b.second), dx + i);
  }
  if (const std::int64_t i = count - 1; count % 2 != 0)
    dx[i] = Narrow(EluGradient(Widen(y[i]), Widen(dy[i])));
}

DEX_VECTORIZED
void ReluGradientArray(std::int64_t count, const BFloat16* y, const BFloat16* dy, BFloat16* dx) {
  DEX_INDEPENDENT
  for (std::int64_t i = 0; i < count / 2 * 2; i += 2) {
    const Two a = Load(y + i), b = Load(dy + i);
    Store(ReluGradient(a.first, b.first), ReluGradient(a.second, b.second), dx + i);
  }
  if (const std::int64_t i = count - 1; count % 2 != 0)
    dx[i] = Narrow(ReluGradient(Widen(y[i]), Widen(dy[i])));
}

DEX_VECTORIZED
void AddTo(std::int64_t count, const BFloat16* x, float* sum) {
  DEX_INDEPENDENT
  for (std::int64_t i = 0; i < count; ++i) sum[i] += Widen(x[i]);
}

DEX_VECTORIZED
void Cast(std::int64_t count, const float* x, BFloat16* y) {
  DEX_INDEPENDENT
  for (std::int64_t i = 0; i < count / 2 * 2; i += 2) Store(x[i], x[i + 1], y + i);
  if (count % 2 != 0) y[count - 1] = Narrow(x[count - 1]);
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
