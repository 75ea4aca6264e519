// A residual over the frozen base policy (RESPRECT, Ceola et al. 2024): a = a_base + a_res, which
// the task clips to [-1, 1] as every action. The residual network sees [o, z, a_base]; its heads
// start at zero, so that training starts at the base policy, value included (there the critic
// starts from the base's too).
//
// NOTE(paper): RESPRECT trains with SAC; here with PPO, as all methods. The residual adds to the
// mean and the exploration noise is that of the sum, with the base's spread to begin with.
#pragma once

#include "policy/actor.h"
#include "policy/encoder.h"
#include "policy/policy.h"

namespace dexremoe {

// Blocks "encoder/*" and "actor/*" as in the base, "residual/*", "log_std". Frozen features of a
// row: z, then the base's mean [A] and value.
template <typename T>
class ResidualPolicy final : public Policy<T> {
 public:
  using W = Wide<T>;
  explicit ResidualPolicy(const PolicyStructure& structure);

  void Initialize(std::uint64_t seed, double log_std, double mean_scale,
                  float* params) const override;
  int frozen_size() const override;
  void Freeze(const T* params, const ShapeInputs<W>& shapes, const PolicyRows<W>& rows,
              Workspace<T>& work, W* frozen) const override;
  void Forward(const T* params, const ShapeInputs<W>& shapes, const PolicyRows<W>& rows,
               Workspace<T>& work, W* mean, W* value) const override;
  void Backward(const T* params, const ShapeInputs<W>& shapes, const PolicyRows<W>& rows,
                Workspace<T>& work, const W* dmean, const W* dvalue, W* grads) const override;

 private:
  int seen() const { return this->structure_.z_size + this->structure_.num_actions; }

  Encoder encoder_;
  Actor base_, residual_;
};

}  // namespace dexremoe
