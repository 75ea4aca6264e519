#include "nn/layers.h"

#include <algorithm>
#include <cmath>

#include "nn/kernels.h"

namespace dexremoe {

template <typename T>
void LinearForward(std::int64_t n, std::int64_t c, std::int64_t k, const T* x, const T* w,
                   const T* b, T* y) {
  for (std::int64_t i = 0; i < n; ++i) std::copy(b, b + k, y + i * k);
  Gemm<T>(false, true, n, k, c, 1, x, c, w, c, 1, y, k);
}

template <typename T>
void LinearBackward(std::int64_t n, std::int64_t c, std::int64_t k, const T* x, const T* w,
                    const T* dy, T* dx, T* dw, T* db) {
  if (dx != nullptr) Gemm<T>(false, false, n, c, k, 1, dy, k, w, c, 0, dx, c);
  if (dw == nullptr) return;
  Gemm<T>(true, false, k, c, n, 1, dy, k, x, c, 1, dw, c);
  for (std::int64_t i = 0; i < n; ++i) AddTo(k, dy + i * k, db);
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

#define DEX_INSTANTIATE(T)                                                                   \
  template void LinearForward(std::int64_t, std::int64_t, std::int64_t, const T*, const T*,  \
                              const T*, T*);                                                 \
  template void LinearBackward(std::int64_t, std::int64_t, std::int64_t, const T*, const T*, \
                               const T*, T*, T*, T*);                                        \
  template void EluForward(std::int64_t, const T*, T*);                                      \
  template void EluBackward(std::int64_t, const T*, const T*, T*);                           \
  template void ReluForward(std::int64_t, const T*, T*);                                     \
  template void ReluBackward(std::int64_t, const T*, const T*, T*);                          \
  template void SoftmaxForward(std::int64_t, std::int64_t, const T*, T*);                    \
  template void SoftmaxBackward(std::int64_t, std::int64_t, const T*, const T*, T*);
DEX_INSTANTIATE(float)
DEX_INSTANTIATE(double)
#undef DEX_INSTANTIATE

}  // namespace dexremoe
