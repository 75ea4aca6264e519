#include "policy/router.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "nn/layers.h"

namespace dexremoe {

template <typename W>
void RouterScores(std::int64_t n, int d, int experts, const W* x, const W* w, W* scores) {
  Gemm<W>(false, true, n, experts, d, 1, x, d, w, d, 0, scores, experts);
}

template <typename W>
void RouterScoresBackward(std::int64_t n, int d, int experts, const W* x, const W* w,
                          const W* dscores, bool add, W* dx, W* dw) {
  Gemm<W>(false, false, n, d, experts, 1, dscores, experts, w, d, add ? W(1) : W(0), dx, d);
  Gemm<W>(true, false, experts, d, n, 1, dscores, experts, x, d, 1, dw, d);
}

template <typename W>
W SquaredVariation(const std::vector<W>& v, std::vector<W>& gradient) {
  const W count = static_cast<W>(v.size());
  const W mean = std::accumulate(v.begin(), v.end(), W(0)) / count;
  W variance = 0;
  for (const W x : v) variance += (x - mean) * (x - mean) / count;
  gradient.resize(v.size());
  for (std::size_t i = 0; i < v.size(); ++i)
    gradient[i] = 2 * (v[i] - mean - variance / mean) / (count * mean * mean);
  return variance / (mean * mean);
}

template <typename W>
void SortScores(int experts, const W* scores, std::vector<int>& order) {
  order.resize(experts);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return scores[a] > scores[b]; });
}

template <typename W>
void AddRouting(std::int64_t n, int experts, const W* weights, const W* shares, RoutingSums& sums) {
  sums.load.resize(experts, 0.0);
  for (std::int64_t r = 0; r < n; ++r, weights += experts, shares += experts) {
    const double total = std::accumulate(weights, weights + experts, 0.0);
    const double whole = std::accumulate(shares, shares + experts, 0.0);
    for (int i = 0; i < experts; ++i) {
      sums.load[i] += weights[i] / total;
      const double share = shares[i] / whole;
      if (share > 0) sums.entropy -= share * std::log(share);
    }
  }
}

#define DEX_INSTANTIATE(W)                                                                       \
  template void RouterScores(std::int64_t, int, int, const W*, const W*, W*);                    \
  template void RouterScoresBackward(std::int64_t, int, int, const W*, const W*, const W*, bool, \
                                     W*, W*);                                                    \
  template W SquaredVariation(const std::vector<W>&, std::vector<W>&);                           \
  template void SortScores(int, const W*, std::vector<int>&);                                    \
  template void AddRouting(std::int64_t, int, const W*, const W*, RoutingSums&);
DEX_INSTANTIATE(float)
DEX_INSTANTIATE(double)
#undef DEX_INSTANTIATE

}  // namespace dexremoe
