#include "nn/normalizer.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace dexremoe {

void UpdateMoments(std::int64_t n, const float* x, RunningMoments& moments) {
  if (n == 0) return;
  const std::size_t columns = moments.mean.size();
  // Sums of differences from the running mean: no cancellation when the mean is large.
  std::vector<double> sum(columns, 0.0), square(columns, 0.0);
  for (std::int64_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < columns; ++j) {
      const double d = x[i * columns + j] - moments.mean[j];
      sum[j] += d;
      square[j] += d * d;
    }
  const double batch = static_cast<double>(n);
  const double total = moments.count + batch;
  for (std::size_t j = 0; j < columns; ++j) {
    const double shift = sum[j] / batch;  // batch mean - running mean
    const double spread = std::max(square[j] - batch * shift * shift, 0.0);
    const double between = shift * shift * moments.count * batch / total;
    moments.variance[j] = (moments.variance[j] * moments.count + spread + between) / total;
    moments.mean[j] += shift * batch / total;
  }
  moments.count = total;
}

void Normalize(const RunningMoments& moments, double clip, std::int64_t n, const float* x,
               float* y) {
  const std::size_t columns = moments.mean.size();
  std::vector<float> mean(columns), scale(columns);
  for (std::size_t j = 0; j < columns; ++j) {
    mean[j] = static_cast<float>(moments.mean[j]);
    scale[j] = static_cast<float>(1 / std::sqrt(moments.variance[j] + 1e-5));
  }
  const float limit = static_cast<float>(clip);
  for (std::int64_t i = 0; i < n; ++i, x += columns, y += columns)
    for (std::size_t j = 0; j < columns; ++j)
      y[j] = std::clamp((x[j] - mean[j]) * scale[j], -limit, limit);
}

}  // namespace dexremoe
