// Running mean and variance per column (parallel variant of Welford; Chan et al. 1979).
#pragma once

#include <cstdint>
#include <vector>

namespace dexremoe {

// Whole state, stored in checkpoints. Starts as mean 0, variance 1, count 1e-4 (rl_games).
struct RunningMoments {
  explicit RunningMoments(int columns = 0) : mean(columns, 0.0), variance(columns, 1.0) {}
  std::vector<double> mean, variance;
  double count = 1e-4;
};

// Merges a batch x [n, columns], summed in row order in double.
void UpdateMoments(std::int64_t n, const float* x, RunningMoments& moments);
// y = clamp((x - mean) / sqrt(variance + 1e-5), -clip, clip); in place allowed.
void Normalize(const RunningMoments& moments, double clip, std::int64_t n, const float* x,
               float* y);

}  // namespace dexremoe
