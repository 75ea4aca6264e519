// The layers of nn/layers.h on bfloat16: bias and activation ride in the product.
#include <algorithm>
#include <bit>
#include <vector>

#include "nn/bf16_product.h"
#include "nn/kernels.h"

namespace dexremoe {
namespace {

// Calls piece(begin, size) for n rows cut into powers of two. Row counts vary (episodes that time
// out, ends of minibatches), and each would be a product to build and keep on every thread: so a
// few serve every count.
template <typename Piece>
void ForEachPiece(std::int64_t n, const Piece& piece) {
  for (std::int64_t begin = 0; begin < n;) {
    const auto size =
        static_cast<std::int64_t>(std::bit_floor(static_cast<std::uint64_t>(n - begin)));
    piece(begin, size);
    begin += size;
  }
}

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
  ForEachPiece(n, [&](std::int64_t begin, std::int64_t rows) {
    Bf16Product product{rows, columns, k};
    product.lda = k;
    product.ldb = columns;
    RunProduct(product, dy + begin * k, w, nullptr, dx + begin * columns);
  });
}

// dw += dy^T x.
void WeightGradient(std::int64_t n, std::int64_t c, std::int64_t k, const BFloat16* x,
                    const BFloat16* dy, float* dw) {
  ForEachPiece(n, [&](std::int64_t begin, std::int64_t rows) {
    Bf16Product product{k, c, rows};
    product.transpose_a = true;
    product.lda = k;
    product.ldb = c;
    product.wide = product.accumulate = true;
    RunProduct(product, dy + begin * k, x + begin * c, nullptr, dw);
  });
}

}  // namespace

template <>
void LinearActivate<BFloat16>(Activation activation, std::int64_t n, std::int64_t c, std::int64_t k,
                              const BFloat16* x, const BFloat16* w, const BFloat16* b,
                              BFloat16* y) {
  ForEachPiece(n, [&](std::int64_t begin, std::int64_t rows) {
    Bf16Product product = ForwardProduct(rows, c, k);
    product.activation = activation;
    RunProduct(product, x + begin * c, w, b, y + begin * k);
  });
}

template <>
void LinearForward<BFloat16>(std::int64_t n, std::int64_t c, std::int64_t k, const BFloat16* x,
                             const BFloat16* w, const BFloat16* b, float* y) {
  ForEachPiece(n, [&](std::int64_t begin, std::int64_t rows) {
    Bf16Product product = ForwardProduct(rows, c, k);
    product.wide = true;
    RunProduct(product, x + begin * c, w, b, y + begin * k);
  });
}

template <>
void LinearBackward<BFloat16>(std::int64_t n, std::int64_t c, std::int64_t k, const BFloat16* x,
                              const BFloat16* w, const BFloat16* dy, BFloat16* dx, float* dw,
                              float* db, std::int64_t first) {
  if (dx != nullptr) InputGradient(n, c, k, w, dy, dx, first);
  if (dw == nullptr) return;
  WeightGradient(n, c, k, x, dy, dw);
  for (std::int64_t i = 0; i < n; ++i) AddTo(k, dy + i * k, db);
}

template <>
void ActivationBackward<BFloat16>(Activation activation, std::int64_t count, const BFloat16* y,
                                  const BFloat16* dy, BFloat16* dx) {
  if (activation == Activation::kElu) EluGradientArray(count, y, dy, dx);
  if (activation == Activation::kRelu) ReluGradientArray(count, y, dy, dx);
}

}  // namespace dexremoe
