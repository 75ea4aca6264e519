#include "shape/max_pool.h"

#include <algorithm>
#include <bit>

#include "nn/vectorized.h"

namespace dexremoe {
namespace {

DEX_VECTORIZED
void TakeLarger(int k, const float* y, std::int32_t row, float* pooled, std::int32_t* winner) {
  DEX_INDEPENDENT
  for (int j = 0; j < k; ++j) {
    const float value = y[j], best = pooled[j];
    const std::int32_t holder = winner[j];
    pooled[j] = value > best ? value : best;
    winner[j] = value > best ? row : holder;
  }
}

DEX_VECTORIZED
void TakeLarger(int k, const BFloat16* y, std::int32_t row, BFloat16* pooled,
                std::int32_t* winner) {
  DEX_INDEPENDENT
  for (int j = 0; j < k; ++j) {
    const BFloat16 value = y[j], best = pooled[j];
    const bool larger = std::bit_cast<float>(std::uint32_t{value.bits} << 16) >
                        std::bit_cast<float>(std::uint32_t{best.bits} << 16);
    const std::int32_t holder = winner[j];
    pooled[j].bits = larger ? value.bits : best.bits;
    winner[j] = larger ? row : holder;
  }
}

void TakeLarger(int k, const double* y, std::int32_t row, double* pooled, std::int32_t* winner) {
  for (int j = 0; j < k; ++j)
    if (y[j] > pooled[j]) {
      pooled[j] = y[j];
      winner[j] = row;
    }
}

}  // namespace

template <typename T>
void MaxPoolForward(const std::vector<int>& begin, int k, const T* y, T* pooled,
                    std::int32_t* winner) {
  for (std::size_t g = 0; g + 1 < begin.size(); ++g, pooled += k, winner += k) {
    const T* first = y + static_cast<std::int64_t>(begin[g]) * k;
    std::copy(first, first + k, pooled);
    std::fill(winner, winner + k, begin[g]);
    for (int row = begin[g] + 1; row < begin[g + 1]; ++row)
      TakeLarger(k, y + static_cast<std::int64_t>(row) * k, row, pooled, winner);
  }
}

template <typename T>
void MaxPoolBackward(int groups, int rows, int k, const T* dpooled, const std::int32_t* winner,
                     T* dy) {
  std::fill(dy, dy + static_cast<std::int64_t>(rows) * k, T());
  for (int g = 0; g < groups; ++g, dpooled += k, winner += k)
    for (int j = 0; j < k; ++j) dy[static_cast<std::int64_t>(winner[j]) * k + j] = dpooled[j];
}

#define DEX_INSTANTIATE(T)                                                                 \
  template void MaxPoolForward(const std::vector<int>&, int, const T*, T*, std::int32_t*); \
  template void MaxPoolBackward(int, int, int, const T*, const std::int32_t*, T*);
DEX_INSTANTIATE(BFloat16)
DEX_INSTANTIATE(float)
DEX_INSTANTIATE(double)
#undef DEX_INSTANTIATE

}  // namespace dexremoe
