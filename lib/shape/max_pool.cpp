#include "shape/max_pool.h"

#include <algorithm>

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
  std::fill(dy, dy + static_cast<std::int64_t>(rows) * k, T(0));
  for (int g = 0; g < groups; ++g, dpooled += k, winner += k)
    for (int j = 0; j < k; ++j) dy[static_cast<std::int64_t>(winner[j]) * k + j] = dpooled[j];
}

template void MaxPoolForward(const std::vector<int>&, int, const float*, float*, std::int32_t*);
template void MaxPoolForward(const std::vector<int>&, int, const double*, double*, std::int32_t*);
template void MaxPoolBackward(int, int, int, const float*, const std::int32_t*, float*);
template void MaxPoolBackward(int, int, int, const double*, const std::int32_t*, double*);

}  // namespace dexremoe
