#include "rl/rank_statistics.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace dexremoe {

RunningMoments EmptyMoments(int columns) {
  RunningMoments moments(columns);
  moments.count = 0;
  return moments;
}

// Chan et al. 1979: the ranks' means first, so that the squares are taken about the common mean.
void MergeMoments(Communicator& communicator, RunningMoments of_rank, RunningMoments& moments) {
  const std::size_t columns = moments.mean.size();
  std::vector<double> mean = of_rank.mean, squares(columns);
  for (double& m : mean) m *= of_rank.count;
  mean.push_back(of_rank.count);
  communicator.Sum(mean);
  const double batch = mean.back(), total = moments.count + batch;
  if (batch == 0) return;
  for (std::size_t j = 0; j < columns; ++j) {
    mean[j] /= batch;
    const double shift = of_rank.mean[j] - mean[j];
    squares[j] = of_rank.count * (of_rank.variance[j] + shift * shift);
  }
  communicator.Sum(squares);
  for (std::size_t j = 0; j < columns; ++j) {
    const double shift = mean[j] - moments.mean[j];
    const double between = shift * shift * moments.count * batch / total;
    moments.variance[j] = (moments.variance[j] * moments.count + squares[j] + between) / total;
    moments.mean[j] += shift * batch / total;
  }
  moments.count = total;
}

double ExplainedVariance(Communicator& communicator, const std::vector<float>& value,
                         const std::vector<float>& target) {
  std::array<double, 3> sums = {static_cast<double>(target.size()), 0, 0};
  for (std::size_t i = 0; i < target.size(); ++i) {
    sums[1] += target[i];
    sums[2] += target[i] - value[i];
  }
  communicator.Sum(sums);
  const double mean = sums[1] / sums[0], error_mean = sums[2] / sums[0];
  std::array<double, 2> squares = {0, 0};
  for (std::size_t i = 0; i < target.size(); ++i) {
    const double error = target[i] - value[i] - error_mean;
    squares[0] += (target[i] - mean) * (target[i] - mean);
    squares[1] += error * error;
  }
  communicator.Sum(squares);
  return squares[0] > 0 ? 1 - squares[1] / squares[0] : 0;
}

void NormalizeAdvantages(Communicator& communicator, std::vector<float>& advantage) {
  std::array<double, 2> sums = {static_cast<double>(advantage.size()), 0};
  for (const float a : advantage) sums[1] += a;
  communicator.Sum(sums);
  const double mean = sums[1] / sums[0];
  std::array<double, 1> square = {0};
  for (const float a : advantage) square[0] += (a - mean) * (a - mean);
  communicator.Sum(square);
  const double spread = std::sqrt(square[0] / sums[0]) + 1e-8;
  for (float& a : advantage) a = static_cast<float>((a - mean) / spread);
}

}  // namespace dexremoe
