// Trunk with an action head and a value head (paper, III-C): [o, z] -> mean, value.
#pragma once

#include "nn/mlp.h"
#include "policy/policy.h"

namespace dexremoe {

template <typename T>
struct ActorPass {
  T* input;  // [o, z] [n, obs_size + z_size]
  T* trunk;  // activations
  // Backward only.
  T* dhidden;  // [n, hidden]
  T* dvalue_hidden;
  T* dhead;   // [n, A + 1]: copies of dmean and dvalue, which the layers overwrite
  T* dinput;  // as input
  T* scratch;
};

// Blocks "NAME/trunk/*", "NAME/mean/*", "NAME/value/*".
class Actor {
 public:
  Actor(ParamLayout& layout, const std::string& name, const PolicyStructure& structure);

  void Initialize(Rng& rng, double mean_scale, float* params) const;

  template <typename T>
  ActorPass<T> Carve(std::int64_t n, Workspace<T>& work) const;
  // z [n, z_size]; mean [n, A] and value [n] are set.
  template <typename T>
  void Forward(const T* params, const PolicyRows<T>& rows, const T* z, ActorPass<T>& pass, T* mean,
               T* value) const;
  // dz [n, z_size] may be null.
  template <typename T>
  void Backward(const T* params, const PolicyRows<T>& rows, ActorPass<T>& pass, const T* dmean,
                const T* dvalue, T* dz, T* grads) const;

 private:
  int obs_size_, z_size_;
  Mlp trunk_, mean_, value_;
};

}  // namespace dexremoe
