// Layers: forward beside backward, on row-major matrices (row = sample), for float and bfloat16
// (training, matrix products through oneDNN) and double (gradient checks). No state: activations
// are the caller's.
//
// Shapes once for all: n samples, c inputs, k outputs; x [n,c], w [k,c], b [k], y [n,k].
// Backward functions take dy = dLoss/dy and ADD to parameter gradients; input gradients are set.
#pragma once

#include <cstdint>

#include "nn/bfloat16.h"

namespace dexremoe {

// C [m,n] = alpha * op(A) op(B) + beta * C, row-major; op is the transpose when asked for.
// One thread; callers spread row blocks over a ThreadPool. Results do not depend on other threads.
template <typename T>
void Gemm(bool transpose_a, bool transpose_b, std::int64_t m, std::int64_t n, std::int64_t k,
          T alpha, const T* a, std::int64_t lda, const T* b, std::int64_t ldb, T beta, T* c,
          std::int64_t ldc);

enum class Activation { kNone, kElu, kRelu };

// y = x w^T + b.
template <typename T>
void LinearForward(std::int64_t n, std::int64_t c, std::int64_t k, const T* x, const T* w,
                   const T* b, Wide<T>* y);
// y = activation(x w^T + b).
template <typename T>
void LinearActivate(Activation activation, std::int64_t n, std::int64_t c, std::int64_t k,
                    const T* x, const T* w, const T* b, T* y);
// dx [n, c - first] is the gradient of the inputs from `first` on; it may be null. dw, db may be
// null together (frozen layer).
template <typename T>
void LinearBackward(std::int64_t n, std::int64_t c, std::int64_t k, const T* x, const T* w,
                    const T* dy, T* dx, Wide<T>* dw, Wide<T>* db, std::int64_t first = 0);

// dx = dy * activation'(x), written with y alone; dx may be dy. Nothing is done for kNone.
template <typename T>
void ActivationBackward(Activation activation, std::int64_t count, const T* y, const T* dy, T* dx);

// y = x for x > 0, exp(x) - 1 otherwise; in place allowed. (Clevert et al. 2015, alpha 1.)
template <typename T>
void EluForward(std::int64_t count, const T* x, T* y);
// dx = dy * elu'(x), written with y alone: y > 0 ? 1 : y + 1. In place (dx == dy) allowed.
template <typename T>
void EluBackward(std::int64_t count, const T* y, const T* dy, T* dx);

template <typename T>
void ReluForward(std::int64_t count, const T* x, T* y);
template <typename T>
void ReluBackward(std::int64_t count, const T* y, const T* dy, T* dx);

// Row-wise softmax of [n,k] (max-shifted).
template <typename T>
void SoftmaxForward(std::int64_t n, std::int64_t k, const T* x, T* y);
template <typename T>
void SoftmaxBackward(std::int64_t n, std::int64_t k, const T* y, const T* dy, T* dx);

// bfloat16 stands in a file of its own.
template <>
void LinearForward(std::int64_t, std::int64_t, std::int64_t, const BFloat16*, const BFloat16*,
                   const BFloat16*, float*);
template <>
void LinearActivate(Activation, std::int64_t, std::int64_t, std::int64_t, const BFloat16*,
                    const BFloat16*, const BFloat16*, BFloat16*);
template <>
void LinearBackward(std::int64_t, std::int64_t, std::int64_t, const BFloat16*, const BFloat16*,
                    const BFloat16*, BFloat16*, float*, float*, std::int64_t);
template <>
void ActivationBackward(Activation, std::int64_t, const BFloat16*, const BFloat16*, BFloat16*);

}  // namespace dexremoe
