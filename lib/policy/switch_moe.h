// Switch routing (Fedus et al. 2021, "Switch Transformers", section 2): one expert a row.
//   p(x) = softmax(W_r (x u)), u uniform in 1 -+ kJitter per component in training
//   y = p_i(x) E_i(x), i = argmax p(x)
//   loss = kBalanceWeight E sum_i f_i P_i, f_i the share of rows that go to i, P_i the mean of p_i
// The routing's entropy (curves: routing_entropy) is that of p(x): the choice has none.
// No expert has a capacity here: every row is served.
#pragma once

#include "policy/router.h"

namespace dexremoe {

template <typename W>
class SwitchRouter final : public Router<W> {
 public:
  static constexpr double kBalanceWeight = 0.01, kJitter = 0.01;
  static constexpr double kInitialVariance = 0.1;  // of the weights, over the number of inputs

  // Block "router/scores" [E, inputs].
  SwitchRouter(ParamLayout& layout, int inputs, int experts);

  void Initialize(Rng& rng, float* params) const override;
  int noise_size() const override { return inputs_; }
  void DrawNoise(Rng& rng, float* noise) const override;
  std::int64_t PassSize(std::int64_t n) const override { return n * (inputs_ + 2 * experts_); }
  void Forward(const W* params, const RouterRows<W>& rows, W* pass, W* weights) const override;
  const W* Shares(std::int64_t n, const W* weights, W* pass) const override;
  double Balance(const RouterRows<W>& rows, const W* weights, W weight, W* pass) const override;
  void Backward(const W* params, const RouterRows<W>& rows, const W* weights, const W* dweights,
                W* pass, W* dinput, W* grads) const override;

 private:
  struct Pass {
    W* input;         // [n, inputs] after the jitter
    W* probability;   // [n, E] p
    W* dprobability;  // [n, E] of the loss
  };
  Pass Split(std::int64_t n, W* pass) const;

  int inputs_, experts_;
  std::int64_t scores_;  // offset of the block
};

}  // namespace dexremoe
