#include "nn/kernels.h"

#include <bit>
#include <cmath>

#include "nn/vectorized.h"

namespace dexremoe {

// exp(x) - 1 for x <= 0, as 2^k (e^r - 1) + (2^k - 1) with x = k ln 2 + r and |r| <= ln(2)/2. For
// k = 0 that is e^r - 1 itself, so nothing cancels near zero; 2^k - 1 is exact down to k = -24, and
// further below the result rounds to -1 anyway. e^r - 1 - r is r^2 times the Taylor polynomial of
// degree 5, whose remainder r^8/8! is below 6e-9 relative. Rounding to the integer k adds and
// subtracts 1.5 * 2^23, which needs no SSE4 instruction.
DEX_VECTORIZED
void EluArray(std::int64_t count, const float* x, float* y) {
  constexpr float kLog2E = 1.44269504f;
  constexpr float kLn2High = 0.693359375f;  // 9 bits, so that k * kLn2High is exact
  constexpr float kLn2Low = -2.12194440e-4f;
  constexpr float kRound = 12582912.0f;
  for (std::int64_t i = 0; i < count; ++i) {
    const float value = x[i];
    const float low = value < 0.0f ? value : 0.0f;
    const float clamped = low > -25.0f ? low : -25.0f;
    const float shifted = clamped * kLog2E + kRound;
    const float k = shifted - kRound;
    const float r = clamped - k * kLn2High - k * kLn2Low;
    float tail = 1.0f / 5040;
    tail = tail * r + 1.0f / 720;
    tail = tail * r + 1.0f / 120;
    tail = tail * r + 1.0f / 24;
    tail = tail * r + 1.0f / 6;
    tail = tail * r + 0.5f;
    const float fraction = r + r * r * tail;
    const float power =
        std::bit_cast<float>((std::bit_cast<std::int32_t>(shifted) << 23) + 0x3f800000);
    const float negative = power * fraction + (power - 1.0f);
    y[i] = value <= 0.0f ? negative : value;
  }
}

void EluArray(std::int64_t count, const double* x, double* y) {
  for (std::int64_t i = 0; i < count; ++i) y[i] = x[i] > 0 ? x[i] : std::expm1(x[i]);
}

DEX_VECTORIZED
void EluGradientArray(std::int64_t count, const float* y, const float* dy, float* dx) {
  for (std::int64_t i = 0; i < count; ++i) {
    const float below = y[i] < 0.0f ? y[i] : 0.0f;
    dx[i] = dy[i] * (1.0f + below);
  }
}

void EluGradientArray(std::int64_t count, const double* y, const double* dy, double* dx) {
  for (std::int64_t i = 0; i < count; ++i) dx[i] = dy[i] * (y[i] > 0 ? 1 : y[i] + 1);
}

DEX_VECTORIZED
void ReluArray(std::int64_t count, const float* x, float* y) {
  for (std::int64_t i = 0; i < count; ++i) y[i] = x[i] < 0.0f ? 0.0f : x[i];
}

void ReluArray(std::int64_t count, const double* x, double* y) {
  for (std::int64_t i = 0; i < count; ++i) y[i] = x[i] < 0 ? 0 : x[i];
}

DEX_VECTORIZED
void ReluGradientArray(std::int64_t count, const float* y, const float* dy, float* dx) {
  for (std::int64_t i = 0; i < count; ++i) {
    const float gradient = dy[i];
    dx[i] = y[i] > 0.0f ? gradient : 0.0f;
  }
}

void ReluGradientArray(std::int64_t count, const double* y, const double* dy, double* dx) {
  for (std::int64_t i = 0; i < count; ++i) dx[i] = y[i] > 0 ? dy[i] : 0;
}

DEX_VECTORIZED
void AddTo(std::int64_t count, const float* x, float* sum) {
  for (std::int64_t i = 0; i < count; ++i) sum[i] += x[i];
}

void AddTo(std::int64_t count, const double* x, double* sum) {
  for (std::int64_t i = 0; i < count; ++i) sum[i] += x[i];
}

}  // namespace dexremoe
