// The base policy and, with frozen encoders, each expert (paper, III-C and III-D).
#pragma once

#include "policy/actor.h"
#include "policy/encoder.h"
#include "policy/policy.h"

namespace dexremoe {

// Frozen features of a row: z, when the encoders are frozen.
template <typename T>
class ActorCritic final : public Policy<T> {
 public:
  explicit ActorCritic(const PolicyStructure& structure);

  void Initialize(std::uint64_t seed, double log_std, double mean_scale,
                  float* params) const override;
  int frozen_size() const override;
  void Freeze(const T* params, const ShapeInputs<Wide<T>>& shapes, const PolicyRows<Wide<T>>& rows,
              Workspace<T>& work, Wide<T>* frozen) const override;
  void Forward(const T* params, const ShapeInputs<Wide<T>>& shapes, const PolicyRows<Wide<T>>& rows,
               Workspace<T>& work, Wide<T>* mean, Wide<T>* value) const override;
  void Backward(const T* params, const ShapeInputs<Wide<T>>& shapes,
                const PolicyRows<Wide<T>>& rows, Workspace<T>& work, const Wide<T>* dmean,
                const Wide<T>* dvalue, Wide<T>* grads) const override;

 private:
  Encoder encoder_;
  Actor actor_;
};

}  // namespace dexremoe
