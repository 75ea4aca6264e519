// Element-wise loops behind the layers: float and bfloat16 ones vectorised, double ones plain (they
// serve the gradient checks). All but Cast allow the output to be one of the inputs.
#pragma once

#include <cstdint>

#include "nn/bfloat16.h"

namespace dexremoe {

// y = x > 0 ? x : exp(x) - 1. The float version has a relative error below 2e-7 everywhere and
// returns -1 below about -17.3; NaN stays NaN.
void EluArray(std::int64_t count, const float* x, float* y);
void EluArray(std::int64_t count, const double* x, double* y);
// dx = dy * (y > 0 ? 1 : y + 1).
void EluGradientArray(std::int64_t count, const float* y, const float* dy, float* dx);
void EluGradientArray(std::int64_t count, const double* y, const double* dy, double* dx);
// y = max(x, 0).
void ReluArray(std::int64_t count, const float* x, float* y);
void ReluArray(std::int64_t count, const double* x, double* y);
// dx = y > 0 ? dy : 0.
void ReluGradientArray(std::int64_t count, const float* y, const float* dy, float* dx);
void ReluGradientArray(std::int64_t count, const double* y, const double* dy, double* dx);
// The same on bfloat16, computed in float and rounded to nearest even.
void EluGradientArray(std::int64_t count, const BFloat16* y, const BFloat16* dy, BFloat16* dx);
void ReluGradientArray(std::int64_t count, const BFloat16* y, const BFloat16* dy, BFloat16* dx);
// sum += x.
void AddTo(std::int64_t count, const float* x, float* sum);
void AddTo(std::int64_t count, const double* x, double* sum);
void AddTo(std::int64_t count, const BFloat16* x, float* sum);
// y = x, rounded to nearest even where y is bfloat16; NaN stays NaN.
void Cast(std::int64_t count, const float* x, BFloat16* y);
void Cast(std::int64_t count, const BFloat16* x, float* y);
void Cast(std::int64_t count, const BFloat16* x, BFloat16* y);
void Cast(std::int64_t count, const float* x, float* y);
void Cast(std::int64_t count, const float* x, double* y);
void Cast(std::int64_t count, const double* x, double* y);

}  // namespace dexremoe
