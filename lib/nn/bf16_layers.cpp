// The layers of nn/layers.h on bfloat16: bias and activation ride in the product.
#include <algorithm>
#include <vector>

#include "nn/bf16_product.h"
#include "nn/kernels.h"

namespace dexremoe {
namespace {

Bf16Product ForwardProduct(std::int64_t n, std::int64_t c, std::int64_t k) {
  Bf16Product product{n, k, c};
  product.transpose_b = true;
  product.lda = product.ldb = c;
  product.bias = true;
  return product;
}

// dx = dy w[:, first:]. The columns are laid out without gaps first: oneDNN's fastest kernels want
// them so.
void InputGradient(std::int64_t n, std::int64_t c, std::int64_t k, const BFloat16* w,
                   const BFloat16* dy, BFloat16* dx, std::int64_t first) {
  const std::int64_t columns = c - first;
  thread_local std::vector<BFloat16> packed;
  if (first > 0) {
    packed.resize(k * columns);
    for (std::int64_t j = 0; j < k; ++j)
      std::copy_n(w + j * c + first, columns, packed.data() + j * columns);
    w = packed.data();
  }
  Bf16Product product{n, columns, k};
  product.lda = k;
  product.ldb = columns;
  RunProduct(product, dy, w, nullptr, dx);
}

}  // namespace

template <>
void LinearActivate<BFloat16>(Activation activation, std::int64_t n, std::int64_t c, std::int64_t k,
                              const BFloat16* x, const BFloat16* w, const BFloat16* b,
                              BFloat16* y) {
  Bf16Product product = ForwardProduct(n, c, k);
  product.activation = activation;
  RunProduct(product, x, w, b, y);
}

template <>
void LinearForward<BFloat16>(std::int64_t n, std::int64_t c, std::int64_t k, const BFloat16* x,
                             const BFloat16* w, const BFloat16* b, float* y) {
  Bf16Product product = ForwardProduct(n, c, k);
  product.wide = true;
  RunProduct(product, x, w, b, y);
}

template <>
void LinearBackward<BFloat16>(std::int64_t n, std::int64_t c, std::int64_t k, const BFloat16* x,
                              const BFloat16* w, const BFloat16* dy, BFloat16* dx, float* dw,
                              float* db, std::int64_t first) {
  if (dx != nullptr) InputGradient(n, c, k, w, dy, dx, first);
  if (dw == nullptr) return;
  Bf16Product product{k, c, n};
  product.transpose_a = true;
  product.lda = k;
  product.ldb = c;
  product.wide = product.accumulate = true;
  RunProduct(product, dy, x, nullptr, dw);
  for (std::int64_t i = 0; i < n; ++i) AddTo(k, dy + i * k, db);
}

template <>
void ActivationBackward<BFloat16>(Activation activation, std::int64_t count, const BFloat16* y,
                                  const BFloat16* dy, BFloat16* dx) {
  if (activation == Activation::kElu) EluGradientArray(count, y, dy, dx);
  if (activation == Activation::kRelu) ReluGradientArray(count, y, dy, dx);
}

}  // namespace dexremoe
