// Matrix products of bfloat16 with sums in float, through oneDNN (AMX or avx512_bf16).
#pragma once

#include <cstddef>
#include <cstdint>

#include "nn/bfloat16.h"
#include "nn/layers.h"

namespace dexremoe {

// C [m,n] = activation(op(A) op(B) + bias), or C += op(A) op(B); row-major, op is the transpose
// when asked for. Everything but the addresses; a primitive is built once per thread and value, and
// kept: callers see to it that the values are few.
struct Bf16Product {
  std::int64_t m = 0, n = 0, k = 0;
  bool transpose_a = false, transpose_b = false;
  std::int64_t lda = 0, ldb = 0;  // elements from row to row of A and B as they lie; C has no gaps
  bool bias = false;              // bfloat16 [n]
  bool wide = false;              // C is float, else bfloat16
  bool accumulate = false;        // C is added to; wide only
  Activation activation = Activation::kNone;

  bool operator==(const Bf16Product&) const = default;
};

// One thread; results do not depend on other threads. `bias` is read only when product.bias, `c` is
// float or BFloat16 as product.wide says. Needs HasNativeBfloat16 to be fast, not to be right.
void RunProduct(const Bf16Product& product, const BFloat16* a, const BFloat16* b,
                const BFloat16* bias, void* c);

// How many different products the calling thread has run.
std::size_t NumProducts();

}  // namespace dexremoe
