#include "nn/layers.h"

#include <algorithm>
#include <cmath>

#include "nn/kernels.h"

namespace dexremoe {

template <typename T>
void LinearForward(std::int64_t n, std::int64_t c, std::int64_t k, const T* x, const T* w,
                   const T* b, Wide<T>* y) {
  LinearActivate<T>(Activation::kNone, n, c, k, x, w, b, y);
}

template <typename T>
void LinearActivate(Activation activation, std::int64_t n, std::int64_t c, std::int64_t k,
                    const T* x, const T* w, const T* b, T* y) {
  Gemm<T>(false, true, n, k, c, 1, x, c, w, c, 0, y, k);
  for (std::int64_t i = 0; i < n;
       ++i, y += k) {  // one row at a time: both passes hit the same cache
    AddTo(k, b, y);
    if (activation == Activation::kElu) EluArray(k, y, y);
    if (activation == Activation::kRelu) ReluArray(k, y, y);
  }
}

template <typename T>
void LinearBackward(std::int64_t n, std::int64_t c, std::int64_t k, const T* x, const T* w,
                    const T* dy, T* dx, Wide<T>* dw, Wide<T>* db, std::int64_t first) {
  const std::int64_t columns = c - first;
  if (dx != nullptr) Gemm<T>(false, false, n, columns, k, 1, dy, k, w + first, c, 0, dx, columns);
  if (dw == nullptr) return;
  Gemm<T>(true, false, k, c, n, 1, dy, k, x, c, 1, dw, c);
  for (std::int64_t i = 0; i < n; ++i) AddTo(k, dy + i * k, db);
}

template <typename T>
void ActivationBackward(Activation activation, std::int64_t count, const T* y, const T* dy, T* dx) {
  if (activation == Activation::kElu) EluGradientArray(count, y, dy, dx);
  if (activation == Activation::kRelu) ReluGradientArray(count, y, dy, dx);
}

template <typename T>
void EluForward(std::int64_t count, const T* x, T* y) {
  EluArray(count, x, y);
}

template <typename T>
void EluBackward(std::int64_t count, const T* y, const T* dy, T* dx) {
  EluGradientArray(count, y, dy, dx);
}

template <typename T>
void ReluForward(std::int64_t count, const T* x, T* y) {
  ReluArray(count, x, y);
}

template <typename T>
void ReluBackward(std::int64_t count, const T* y, const T* dy, T* dx) {
  ReluGradientArray(count, y, dy, dx);
}

template <typename T>
void SoftmaxForward(std::int64_t n, std::int64_t k, const T* x, T* y) {
  for (std::int64_t i = 0; i < n; ++i, x += k, y += k) {
    const T largest = *std::max_element(x, x + k);
    T sum = 0;
    for (std::int64_t j = 0; j < k; ++j) sum += y[j] = std::exp(x[j] - largest);
    for (std::int64_t j = 0; j < k; ++j) y[j] /= sum;
  }
}

template <typename T>
void SoftmaxBackward(std::int64_t n, std::int64_t k, const T* y, const T* dy, T* dx) {
  for (std::int64_t i = 0; i < n; ++i, y += k, dy += k, dx += k) {
    T inner = 0;
    for (std::int64_t j = 0; j < k; ++j) inner += y[j] * dy[j];
    for (std::int64_t j = 0; j < k; ++j) dx[j] = y[j] * (dy[j] - inner);
  }
}

#define DEX_INSTANTIATE(T)                                                                     \
  template void LinearForward(std::int64_t, std::int64_t, std::int64_t, const T*, const T*,    \
                              const T*, T*);                                                   \
  template void LinearBackward(std::int64_t, std::int64_t, std::int64_t, const T*, const T*,   \
                               const T*, T*, T*, T*, std::int64_t);                            \
  template void LinearActivate(Activation, std::int64_t, std::int64_t, std::int64_t, const T*, \
                               const T*, const T*, T*);                                        \
  template void ActivationBackward(Activation, std::int64_t, const T*, const T*, T*);          \
  template void EluForward(std::int64_t, const T*, T*);                                        \
  template void EluBackward(std::int64_t, const T*, const T*, T*);                             \
  template void ReluForward(std::int64_t, const T*, T*);                                       \
  template void ReluBackward(std::int64_t, const T*, const T*, T*);                            \
  template void SoftmaxForward(std::int64_t, std::int64_t, const T*, T*);                      \
  template void SoftmaxBackward(std::int64_t, std::int64_t, const T*, const T*, T*);
DEX_INSTANTIATE(float)
DEX_INSTANTIATE(double)
#undef DEX_INSTANTIATE

}  // namespace dexremoe
