#include "policy/actor.h"

#include <algorithm>

namespace dexremoe {
namespace {

std::vector<int> TrunkWidths(const PolicyStructure& s) {
  std::vector<int> widths = {s.obs_size + s.z_size};
  widths.insert(widths.end(), s.hidden.begin(), s.hidden.end());
  return widths;
}

}  // namespace

Actor::Actor(ParamLayout& layout, const std::string& name, const PolicyStructure& s)
    : obs_size_(s.obs_size),
      z_size_(s.z_size),
      trunk_(layout, name + "/trunk", TrunkWidths(s), true),
      mean_(layout, name + "/mean", {s.hidden.back(), s.num_actions}, false),
      value_(layout, name + "/value", {s.hidden.back(), 1}, false) {}

void Actor::Initialize(Rng& rng, double mean_scale, float* params) const {
  trunk_.Initialize(rng, 1, params);
  mean_.Initialize(rng, mean_scale, params);
  value_.Initialize(rng, 1, params);
}

template <typename T>
ActorPass<T> Actor::Carve(std::int64_t n, Workspace<T>& work) const {
  ActorPass<T> pass;
  pass.input = work.Take(n * trunk_.inputs());
  pass.trunk = work.Take(trunk_.ActivationSize(n));
  pass.dhidden = work.Take(n * trunk_.outputs());
  pass.dvalue_hidden = work.Take(n * trunk_.outputs());
  pass.dhead = work.Take(n * (mean_.outputs() + 1));
  pass.dinput = work.Take(n * trunk_.inputs());
  pass.scratch = work.Take(trunk_.ScratchSize(n));
  return pass;
}

template <typename T>
void Actor::Forward(const T* params, const PolicyRows<T>& rows, const T* z, ActorPass<T>& pass,
                    T* mean, T* value) const {
  T* input = pass.input;
  for (std::int64_t r = 0; r < rows.n; ++r) {
    input = std::copy_n(rows.obs + r * obs_size_, obs_size_, input);
    input = std::copy_n(z + r * z_size_, z_size_, input);
  }
  const T* hidden = trunk_.Forward(params, rows.n, pass.input, pass.trunk);
  mean_.Forward(params, rows.n, hidden, mean);
  value_.Forward(params, rows.n, hidden, value);
}

template <typename T>
void Actor::Backward(const T* params, const PolicyRows<T>& rows, ActorPass<T>& pass, const T* dmean,
                     const T* dvalue, T* dz, T* grads) const {
  const std::int64_t n = rows.n;
  const T* hidden = pass.trunk + trunk_.ActivationSize(n) - n * trunk_.outputs();
  T* dmean_copy = pass.dhead;
  T* dvalue_copy = std::copy_n(dmean, n * mean_.outputs(), dmean_copy);
  std::copy_n(dvalue, n, dvalue_copy);
  // The heads are single layers: they need neither their outputs nor scratch.
  mean_.Backward(params, n, hidden, dmean_copy, dmean_copy, pass.dhidden, grads, pass.scratch);
  value_.Backward(params, n, hidden, dvalue_copy, dvalue_copy, pass.dvalue_hidden, grads,
                  pass.scratch);
  for (std::int64_t i = 0; i < n * trunk_.outputs(); ++i) pass.dhidden[i] += pass.dvalue_hidden[i];
  trunk_.Backward(params, n, pass.input, pass.trunk, pass.dhidden,
                  dz != nullptr ? pass.dinput : nullptr, grads, pass.scratch);
  if (dz == nullptr) return;
  for (std::int64_t r = 0; r < n; ++r)
    std::copy_n(pass.dinput + r * trunk_.inputs() + obs_size_, z_size_, dz + r * z_size_);
}

#define DEX_INSTANTIATE(T)                                                                         \
  template ActorPass<T> Actor::Carve(std::int64_t, Workspace<T>&) const;                           \
  template void Actor::Forward(const T*, const PolicyRows<T>&, const T*, ActorPass<T>&, T*, T*)    \
      const;                                                                                       \
  template void Actor::Backward(const T*, const PolicyRows<T>&, ActorPass<T>&, const T*, const T*, \
                                T*, T*) const;
DEX_INSTANTIATE(float)
DEX_INSTANTIATE(double)
#undef DEX_INSTANTIATE

}  // namespace dexremoe
