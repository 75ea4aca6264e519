#include "policy/sparse_moe.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dexremoe {
namespace {

template <typename W>
W Softplus(W x) {
  return x > 0 ? x + std::log1p(std::exp(-x)) : std::log1p(std::exp(x));
}
template <typename W>
W Sigmoid(W x) {
  return 1 / (1 + std::exp(-x));
}
template <typename W>
W NormalDensity(W x) {
  return std::exp(W(-0.5) * x * x) / std::sqrt(2 * std::numbers::pi_v<W>);
}
template <typename W>
W NormalCumulative(W x) {
  return W(0.5) * std::erfc(-x / std::numbers::sqrt2_v<W>);
}

}  // namespace

template <typename W>
NoisyTopK<W>::NoisyTopK(ParamLayout& layout, int inputs, int experts, int k)
    : inputs_(inputs), experts_(experts), k_(k) {
  scores_ = layout.block(layout.Add("router/scores", experts, inputs)).offset;
  noise_ = layout.block(layout.Add("router/noise", experts, inputs)).offset;
}

template <typename W>
void NoisyTopK<W>::Initialize(Rng& /*rng*/, float* params) const {
  std::fill_n(params + scores_, experts_ * inputs_, 0.0f);
  std::fill_n(params + noise_, experts_ * inputs_, 0.0f);
}

template <typename W>
void NoisyTopK<W>::DrawNoise(Rng& rng, float* noise) const {
  for (int i = 0; i < experts_; ++i) noise[i] = static_cast<float>(rng.Normal());
}

template <typename W>
typename NoisyTopK<W>::Pass NoisyTopK<W>::Split(std::int64_t n, W* pass) const {
  const std::int64_t size = n * experts_;
  return {pass, pass + size, pass + 2 * size, pass + 3 * size, pass + 4 * size, pass + 5 * size};
}

template <typename W>
void NoisyTopK<W>::Forward(const W* params, const RouterRows<W>& rows, W* pass, W* weights) const {
  const Pass p = Split(rows.n, pass);
  const std::int64_t size = rows.n * experts_;
  RouterScores(rows.n, inputs_, experts_, rows.input, params + scores_, p.clean);
  RouterScores(rows.n, inputs_, experts_, rows.input, params + noise_, p.raw);
  for (std::int64_t i = 0; i < size; ++i)
    p.noisy[i] = p.clean[i] + (rows.noise != nullptr ? rows.noise[i] * Softplus(p.raw[i]) : W(0));
  std::fill_n(p.dweights, 3 * size, W(0));
  std::fill_n(weights, size, W(0));
  std::vector<int> order;
  for (std::int64_t r = 0; r < rows.n; ++r) {
    const W* h = p.noisy + r * experts_;
    W* g = weights + r * experts_;
    SortScores(experts_, h, order);
    W sum = 0;
    for (int j = 0; j < k_; ++j) sum += g[order[j]] = std::exp(h[order[j]] - h[order[0]]);
    for (int j = 0; j < k_; ++j) g[order[j]] /= sum;
  }
}

template <typename W>
double NoisyTopK<W>::ImportanceLoss(std::int64_t n, const W* weights, W weight, W* dweights) const {
  std::vector<W> importance(experts_, W(0)), gradient;
  for (std::int64_t i = 0; i < n * experts_; ++i) importance[i % experts_] += weights[i];
  const W loss = SquaredVariation(importance, gradient);
  for (std::int64_t i = 0; i < n * experts_; ++i)
    dweights[i] += weight * static_cast<W>(kImportanceWeight) * gradient[i % experts_];
  return kImportanceWeight * loss;
}

// The load's estimate is smooth: the chance that an expert would be chosen under fresh noise of its
// own, with the noise of the others as it is.
template <typename W>
double NoisyTopK<W>::LoadLoss(const RouterRows<W>& rows, W weight, Pass& p) const {
  struct Chance {
    int rival;  // whose score is the threshold
    W density, distance;
  };
  std::vector<Chance> chances(rows.n * experts_);
  std::vector<W> load(experts_, W(0)), gradient;
  std::vector<int> order, place(experts_);
  for (std::int64_t r = 0; r < rows.n; ++r) {
    const std::int64_t row = r * experts_;
    SortScores(experts_, p.noisy + row, order);
    for (int j = 0; j < experts_; ++j) place[order[j]] = j;
    for (int i = 0; i < experts_; ++i) {
      const int rival = order[place[i] < k_ ? k_ : k_ - 1];
      const W distance = (p.clean[row + i] - p.noisy[row + rival]) / Softplus(p.raw[row + i]);
      load[i] += NormalCumulative(distance);
      chances[row + i] = {rival, NormalDensity(distance), distance};
    }
  }
  const W loss = SquaredVariation(load, gradient);
  for (std::int64_t e = 0; e < rows.n * experts_; ++e) {
    const Chance& chance = chances[e];
    const std::int64_t rival = e - e % experts_ + chance.rival;
    const W d = weight * static_cast<W>(kLoadWeight) * gradient[e % experts_] * chance.density /
                Softplus(p.raw[e]);
    p.dclean[e] += d;
    p.dspread[e] -= d * chance.distance;
    p.dclean[rival] -= d;
    p.dspread[rival] -= d * rows.noise[rival];
  }
  return kLoadWeight * loss;
}

template <typename W>
double NoisyTopK<W>::Balance(const RouterRows<W>& rows, const W* weights, W weight, W* pass) const {
  Pass p = Split(rows.n, pass);
  const double importance = ImportanceLoss(rows.n, weights, weight, p.dweights);
  return importance + (rows.noise != nullptr && k_ < experts_ ? LoadLoss(rows, weight, p) : 0.0);
}

template <typename W>
void NoisyTopK<W>::Backward(const W* params, const RouterRows<W>& rows, const W* weights,
                            const W* dweights, W* pass, W* dinput, W* grads) const {
  Pass p = Split(rows.n, pass);
  for (std::int64_t r = 0; r < rows.n; ++r) {
    const std::int64_t row = r * experts_;
    W inner = 0;
    for (std::int64_t e = row; e < row + experts_; ++e)
      inner += weights[e] * (dweights[e] + p.dweights[e]);
    for (std::int64_t e = row; e < row + experts_; ++e) {
      const W dscore = weights[e] * (dweights[e] + p.dweights[e] - inner);
      p.dclean[e] += dscore;
      if (rows.noise != nullptr) p.dspread[e] += dscore * rows.noise[e];
    }
  }
  for (std::int64_t e = 0; e < rows.n * experts_; ++e) p.dspread[e] *= Sigmoid(p.raw[e]);
  RouterScoresBackward(rows.n, inputs_, experts_, rows.input, params + scores_, p.dclean, false,
                       dinput, grads + scores_);
  RouterScoresBackward(rows.n, inputs_, experts_, rows.input, params + noise_, p.dspread, true,
                       dinput, grads + noise_);
}

template class NoisyTopK<float>;
template class NoisyTopK<double>;

}  // namespace dexremoe
