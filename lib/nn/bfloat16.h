// The storage type of low-precision networks: the upper half of a float (8 bits of exponent, 8 of
// mantissa with the hidden one; relative rounding error at most 2^-8). No arithmetic: products are
// oneDNN's, which sums in float; everything else goes through float.
#pragma once

#include <cstdint>

namespace dexremoe {

struct BFloat16 {
  std::uint16_t bits = 0;
};

namespace internal {
template <typename T>
struct WideOf {
  using Type = T;
};
template <>
struct WideOf<BFloat16> {
  using Type = float;
};
}  // namespace internal

// What a network of storage type T sums in: its gradients, and what it takes and gives.
template <typename T>
using Wide = typename internal::WideOf<T>::Type;

}  // namespace dexremoe
