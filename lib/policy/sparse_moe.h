// Noisy top-k gating (Shazeer et al. 2017, "Outrageously Large Neural Networks", section 3):
//   H(x)_i = (x W_g)_i + e_i softplus((x W_noise)_i), e standard normal
//   G(x) = softmax(KeepTopK(H(x), k)), y = sum_i G(x)_i E_i(x)
//   loss = kImportanceWeight CV^2(sum_x G(x)) + kLoadWeight CV^2(sum_x P(x))
//   P(x)_i = Phi(((x W_g)_i - kth_excluding(H(x), k, i)) / softplus((x W_noise)_i))
// Both matrices start at zero, which spreads the load evenly.
//
// Without noise (acting deterministically) the k best of x W_g act, and there is no load loss.
#pragma once

#include "policy/router.h"
#include "policy/structure.h"

namespace dexremoe {

template <typename W>
class NoisyTopK final : public Router<W> {
 public:
  static constexpr double kImportanceWeight = 0.01, kLoadWeight = 0.01;

  // Blocks "router/scores" and "router/noise" [E, inputs].
  NoisyTopK(ParamLayout& layout, int inputs, int experts, int k);

  void Initialize(Rng& rng, float* params) const override;
  int noise_size() const override { return experts_; }
  void DrawNoise(Rng& rng, float* noise) const override;
  std::int64_t PassSize(std::int64_t n) const override { return kArrays * n * experts_; }
  void Forward(const W* params, const RouterRows<W>& rows, W* pass, W* weights) const override;
  double Balance(const RouterRows<W>& rows, const W* weights, W weight, W* pass) const override;
  void Backward(const W* params, const RouterRows<W>& rows, const W* weights, const W* dweights,
                W* pass, W* dinput, W* grads) const override;

 private:
  // What `pass` holds, each [n, E].
  static constexpr int kArrays = 6;
  struct Pass {
    W *clean, *raw, *noisy;          // x W_g, x W_noise, H
    W *dweights, *dclean, *dspread;  // of the losses; dspread: of softplus(raw)
  };
  Pass Split(std::int64_t n, W* pass) const;
  double ImportanceLoss(std::int64_t n, const W* weights, W weight, W* dweights) const;
  double LoadLoss(const RouterRows<W>& rows, W weight, Pass& pass) const;

  int inputs_, experts_, k_;
  std::int64_t scores_, noise_;  // offsets of the blocks
};

}  // namespace dexremoe
