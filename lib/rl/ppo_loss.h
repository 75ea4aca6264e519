// The terms of the PPO loss for one row, each beside its partial derivatives (named d..._d...).
// A actions; the policy is a diagonal Gaussian with mean [A] and log_std [A].
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace dexremoe {

// log_std and what follows from it alone: computed once per policy, not per row.
template <typename T>
struct ActionSpread {
  ActionSpread(int actions, const T* values) : log_std(values, values + actions) {
    for (const T value : log_std) {
      inverse.push_back(std::exp(-value));
      log_volume += value + T(0.5) * std::log(2 * std::numbers::pi_v<T>);
    }
  }
  int actions() const { return static_cast<int>(log_std.size()); }

  std::vector<T> log_std, inverse;  // [A]; inverse = exp(-log_std)
  T log_volume = 0;                 // -log N(mean; mean, exp(log_std))
};

// log N(action; mean, exp(log_std)).
template <typename T>
T LogProbability(const ActionSpread<T>& spread, const T* action, const T* mean) {
  T square = 0;
  for (int a = 0; a < spread.actions(); ++a) {
    const T e = (action[a] - mean[a]) * spread.inverse[a];
    square += e * e;
  }
  return T(-0.5) * square - spread.log_volume;
}

// Adds weight * d logp / d mean to dmean [A] and weight * d logp / d log_std to dlog_std [A].
template <typename T>
void AddLogProbabilityGradient(const ActionSpread<T>& spread, const T* action, const T* mean,
                               T weight, T* dmean, double* dlog_std) {
  for (int a = 0; a < spread.actions(); ++a) {
    const T e = (action[a] - mean[a]) * spread.inverse[a];
    dmean[a] += weight * e * spread.inverse[a];
    dlog_std[a] += static_cast<double>(weight * (e * e - 1));
  }
}

template <typename T>
struct SurrogateLoss {
  T loss;
  T dloss_dlogp;
  bool clipped;
};

// -min(ratio A, clamp(ratio, 1 - clip, 1 + clip) A), ratio = exp(logp - old_logp)
// (Schulman et al. 2017, eq. 7).
template <typename T>
SurrogateLoss<T> Surrogate(T logp, T old_logp, T advantage, T clip) {
  const T ratio = std::exp(logp - old_logp);
  const T plain = ratio * advantage;
  const T limited = std::clamp(ratio, 1 - clip, 1 + clip) * advantage;
  if (limited < plain) return {-limited, 0, true};
  return {-plain, -plain, false};
}

template <typename T>
struct ValueLoss {
  T loss;
  T dloss_dvalue;
};

// (value - target)^2, or with clipping the larger of it and the same for a value that moved at most
// `clip` from the old one. All in normalised units.
template <typename T>
ValueLoss<T> SquaredValueLoss(T value, T old_value, T target, T clip, bool clipping) {
  const T plain = (value - target) * (value - target);
  const T moved = old_value + std::clamp(value - old_value, -clip, clip);
  const T limited = (moved - target) * (moved - target);
  if (clipping && limited > plain) return {limited, 0};
  return {plain, 2 * (value - target)};
}

// sum_a max(|mean_a| - bounds, 0)^2; adds weight times its gradient to dmean.
// NOTE(paper): silent; the correct two-sided form of rl_games, not Hora's, which pulls every mean
// towards +bounds.
template <typename T>
T BoundsLoss(int actions, const T* mean, T bounds, T weight, T* dmean) {
  T sum = 0;
  for (int a = 0; a < actions; ++a) {
    const T over = std::max(mean[a] - bounds, T(0)) + std::min(mean[a] + bounds, T(0));
    sum += over * over;
    dmean[a] += weight * 2 * over;
  }
  return sum;
}

// Entropy of the Gaussian; its derivative by each log_std is 1.
template <typename T>
T Entropy(int actions, const T* log_std) {
  T sum = 0;
  for (int a = 0; a < actions; ++a)
    sum += log_std[a] + T(0.5) * std::log(2 * std::numbers::pi_v<T> * std::numbers::e_v<T>);
  return sum;
}

// KL(N(mean0, std0) || N(mean1, std1)), nats, summed over the actions, is the sum of two parts:
// what the spreads differ by, the same for all rows, and what the means differ by.
template <typename T>
T KlOfSpreads(const ActionSpread<T>& spread0, const ActionSpread<T>& spread1) {
  T sum = 0;
  for (int a = 0; a < spread0.actions(); ++a) {
    const T wider = spread1.log_std[a] - spread0.log_std[a];
    sum += wider + T(0.5) * (std::exp(-2 * wider) - 1);
  }
  return sum;
}
template <typename T>
T KlOfMeans(const T* mean0, const T* mean1, const ActionSpread<T>& spread1) {
  T square = 0;
  for (int a = 0; a < spread1.actions(); ++a) {
    const T shift = (mean1[a] - mean0[a]) * spread1.inverse[a];
    square += shift * shift;
  }
  return T(0.5) * square;
}

}  // namespace dexremoe
