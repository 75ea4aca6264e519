// Trunk with an action head and a value head (paper, III-C): [o, z] -> mean, value.
#pragma once

#include "nn/mlp.h"
#include "policy/policy.h"

namespace dexremoe {

template <typename T>
struct ActorPass {
  T* input;        // [o, z] [n, obs_size + z_size]
  T* trunk;        // activations
  T* head_weight;  // both heads as one layer [A + 1, hidden], the value's row last
  T* head_bias;    // [A + 1]
  Wide<T>* head;   // [n, A + 1]
  // Backward only.
  T* dhead;               // [n, A + 1]
  Wide<T>* dhead_weight;  // as head_weight
  Wide<T>* dhead_bias;
  T* dhidden;  // [n, hidden]
  T* dz;       // [n, z_size]
  T* scratch;
};

// Blocks "NAME/trunk/*", "NAME/mean/*", "NAME/value/*".
class Actor {
 public:
  Actor(ParamLayout& layout, const std::string& name, const PolicyStructure& structure);

  void Initialize(Rng& rng, double mean_scale, float* params) const;

  template <typename T>
  ActorPass<T> Carve(std::int64_t n, Workspace<T>& work) const;
  // z, stored or wide: of rows.n rows, or of those that `pick` [rows.n] names, which also picks
  // from rows.obs. mean [n, A] and value [n] are set.
  template <typename T, typename Z>
  void Forward(const T* params, const PolicyRows<Wide<T>>& rows, const Z* z, ActorPass<T>& pass,
               Wide<T>* mean, Wide<T>* value, const int* pick = nullptr) const;
  // Returns the gradient of z [n, z_size], or null when it is not wanted.
  template <typename T>
  T* Backward(const T* params, const PolicyRows<Wide<T>>& rows, ActorPass<T>& pass,
              const Wide<T>* dmean, const Wide<T>* dvalue, bool want_dz, Wide<T>* grads) const;

 private:
  template <typename T>
  void GatherHeads(const T* params, ActorPass<T>& pass) const;
  template <typename T>
  void HeadsBackward(std::int64_t n, const T* hidden, ActorPass<T>& pass, const Wide<T>* dmean,
                     const Wide<T>* dvalue, Wide<T>* grads) const;

  int obs_size_, z_size_, hidden_, actions_;
  Mlp trunk_, mean_, value_;
  std::int64_t mean_weight_, mean_bias_, value_weight_, value_bias_;  // offsets of the heads
};

// structure.experts actors, "expert0", "expert1", ...
std::vector<Actor> MakeExperts(ParamLayout& layout, const PolicyStructure& structure);

}  // namespace dexremoe
