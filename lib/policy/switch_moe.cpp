#include "policy/switch_moe.h"

#include <algorithm>
#include <cmath>

#include "nn/layers.h"

namespace dexremoe {

template <typename W>
SwitchRouter<W>::SwitchRouter(ParamLayout& layout, int inputs, int experts)
    : inputs_(inputs),
      experts_(experts),
      scores_(layout.block(layout.Add("router/scores", experts, inputs)).offset) {}

template <typename W>
void SwitchRouter<W>::Initialize(Rng& rng, float* params) const {
  const double deviation = std::sqrt(kInitialVariance / inputs_);
  for (int i = 0; i < experts_ * inputs_; ++i)
    params[scores_ + i] = static_cast<float>(deviation * rng.Normal());
}

template <typename W>
void SwitchRouter<W>::DrawNoise(Rng& rng, float* noise) const {
  for (int i = 0; i < inputs_; ++i)
    noise[i] = static_cast<float>(rng.Uniform(1 - kJitter, 1 + kJitter));
}

template <typename W>
typename SwitchRouter<W>::Pass SwitchRouter<W>::Split(std::int64_t n, W* pass) const {
  return {pass, pass + n * inputs_, pass + n * (inputs_ + experts_)};
}

template <typename W>
void SwitchRouter<W>::Forward(const W* params, const RouterRows<W>& rows, W* pass,
                              W* weights) const {
  const Pass p = Split(rows.n, pass);
  for (std::int64_t i = 0; i < rows.n * inputs_; ++i)
    p.input[i] = rows.input[i] * (rows.noise != nullptr ? rows.noise[i] : W(1));
  RouterScores(rows.n, inputs_, experts_, p.input, params + scores_, p.probability);
  SoftmaxForward<W>(rows.n, experts_, p.probability, p.probability);
  std::fill_n(p.dprobability, rows.n * experts_, W(0));
  std::fill_n(weights, rows.n * experts_, W(0));
  for (std::int64_t row = 0; row < rows.n * experts_; row += experts_) {
    const W* best = std::max_element(p.probability + row, p.probability + row + experts_);
    weights[best - p.probability] = *best;
  }
}

template <typename W>
const W* SwitchRouter<W>::Shares(std::int64_t n, const W*, W* pass) const {
  return Split(n, pass).probability;
}

template <typename W>
double SwitchRouter<W>::Balance(const RouterRows<W>& rows, const W* weights, W weight,
                                W* pass) const {
  const Pass p = Split(rows.n, pass);
  std::vector<double> routed(experts_, 0.0), probability(experts_, 0.0);
  for (std::int64_t e = 0; e < rows.n * experts_; ++e) {
    routed[e % experts_] += (weights[e] > 0 ? 1.0 : 0.0) / static_cast<double>(rows.n);
    probability[e % experts_] += p.probability[e] / static_cast<double>(rows.n);
  }
  double loss = 0;
  for (int i = 0; i < experts_; ++i) loss += kBalanceWeight * experts_ * routed[i] * probability[i];
  for (std::int64_t e = 0; e < rows.n * experts_; ++e)
    p.dprobability[e] += static_cast<W>(weight * kBalanceWeight * experts_ * routed[e % experts_] /
                                        static_cast<double>(rows.n));
  return loss;
}

template <typename W>
void SwitchRouter<W>::Backward(const W* params, const RouterRows<W>& rows, const W* weights,
                               const W* dweights, W* pass, W* dinput, W* grads) const {
  const Pass p = Split(rows.n, pass);
  for (std::int64_t e = 0; e < rows.n * experts_; ++e)
    if (weights[e] > 0) p.dprobability[e] += dweights[e];
  SoftmaxBackward<W>(rows.n, experts_, p.probability, p.dprobability, p.dprobability);
  RouterScoresBackward(rows.n, inputs_, experts_, p.input, params + scores_, p.dprobability, false,
                       dinput, grads + scores_);
  if (rows.noise == nullptr) return;
  for (std::int64_t i = 0; i < rows.n * inputs_; ++i) dinput[i] *= rows.noise[i];
}

template class SwitchRouter<float>;
template class SwitchRouter<double>;

}  // namespace dexremoe
