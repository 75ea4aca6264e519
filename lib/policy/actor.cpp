#include "policy/actor.h"

#include <algorithm>

#include "nn/kernels.h"

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
      hidden_(s.hidden.back()),
      actions_(s.num_actions),
      trunk_(layout, name + "/trunk", TrunkWidths(s), true),
      mean_(layout, name + "/mean", {hidden_, actions_}, false),
      value_(layout, name + "/value", {hidden_, 1}, false),
      mean_weight_(layout.block(mean_.weight(0)).offset),
      mean_bias_(layout.block(mean_.bias(0)).offset),
      value_weight_(layout.block(value_.weight(0)).offset),
      value_bias_(layout.block(value_.bias(0)).offset) {}

void Actor::Initialize(Rng& rng, double mean_scale, float* params) const {
  trunk_.Initialize(rng, 1, params);
  mean_.Initialize(rng, mean_scale, params);
  value_.Initialize(rng, 1, params);
}

template <typename T>
ActorPass<T> Actor::Carve(std::int64_t n, Workspace<T>& work) const {
  const int outputs = actions_ + 1;
  ActorPass<T> pass;
  pass.input = work.Take(n * trunk_.inputs());
  pass.trunk = work.Take(trunk_.ActivationSize(n));
  pass.head_weight = work.Take(outputs * hidden_);
  pass.head_bias = work.Take(outputs);
  pass.head = work.template Take<Wide<T>>(n * outputs);
  pass.dhead = work.Take(n * outputs);
  pass.dhead_weight = work.template Take<Wide<T>>(outputs * hidden_);
  pass.dhead_bias = work.template Take<Wide<T>>(outputs);
  pass.dhidden = work.Take(n * hidden_);
  pass.dz = work.Take(n * z_size_);
  pass.scratch = work.Take(trunk_.ScratchSize(n));
  return pass;
}

template <typename T>
void Actor::GatherHeads(const T* params, ActorPass<T>& pass) const {
  std::copy_n(params + value_weight_, hidden_,
              std::copy_n(params + mean_weight_, actions_ * hidden_, pass.head_weight));
  *std::copy_n(params + mean_bias_, actions_, pass.head_bias) = params[value_bias_];
}

template <typename T, typename Z>
void Actor::Forward(const T* params, const PolicyRows<Wide<T>>& rows, const Z* z,
                    ActorPass<T>& pass, Wide<T>* mean, Wide<T>* value, const int* pick) const {
  for (std::int64_t r = 0; r < rows.n; ++r) {
    const std::int64_t from = pick != nullptr ? pick[r] : r;
    T* input = pass.input + r * trunk_.inputs();
    Cast(obs_size_, rows.obs + from * obs_size_, input);
    Cast(z_size_, z + from * z_size_, input + obs_size_);
  }
  const T* hidden = trunk_.Forward(params, rows.n, pass.input, pass.trunk);
  GatherHeads(params, pass);
  LinearForward<T>(rows.n, hidden_, actions_ + 1, hidden, pass.head_weight, pass.head_bias,
                   pass.head);
  const Wide<T>* head = pass.head;
  for (std::int64_t r = 0; r < rows.n; ++r, head += actions_ + 1) {
    std::copy_n(head, actions_, mean + r * actions_);
    value[r] = head[actions_];
  }
}

template <typename T>
void Actor::HeadsBackward(std::int64_t n, const T* hidden, ActorPass<T>& pass, const Wide<T>* dmean,
                          const Wide<T>* dvalue, Wide<T>* grads) const {
  const int outputs = actions_ + 1;
  for (std::int64_t r = 0; r < n; ++r) {
    Cast(actions_, dmean + r * actions_, pass.dhead + r * outputs);
    Cast(1, dvalue + r, pass.dhead + r * outputs + actions_);
  }
  std::fill_n(pass.dhead_weight, outputs * hidden_, Wide<T>(0));
  std::fill_n(pass.dhead_bias, outputs, Wide<T>(0));
  LinearBackward<T>(n, hidden_, outputs, hidden, pass.head_weight, pass.dhead, pass.dhidden,
                    pass.dhead_weight, pass.dhead_bias);
  AddTo(actions_ * hidden_, pass.dhead_weight, grads + mean_weight_);
  AddTo(hidden_, pass.dhead_weight + actions_ * hidden_, grads + value_weight_);
  AddTo(actions_, pass.dhead_bias, grads + mean_bias_);
  AddTo(1, pass.dhead_bias + actions_, grads + value_bias_);
}

template <typename T>
T* Actor::Backward(const T* params, const PolicyRows<Wide<T>>& rows, ActorPass<T>& pass,
                   const Wide<T>* dmean, const Wide<T>* dvalue, bool want_dz,
                   Wide<T>* grads) const {
  const T* hidden = pass.trunk + trunk_.ActivationSize(rows.n) - rows.n * hidden_;
  HeadsBackward(rows.n, hidden, pass, dmean, dvalue, grads);
  T* dz = want_dz ? pass.dz : nullptr;
  trunk_.Backward(params, rows.n, pass.input, pass.trunk, pass.dhidden, dz, grads, pass.scratch,
                  obs_size_);
  return dz;
}

std::vector<Actor> MakeExperts(ParamLayout& layout, const PolicyStructure& s) {
  std::vector<Actor> experts;
  for (int i = 0; i < s.experts; ++i) experts.emplace_back(layout, "expert" + std::to_string(i), s);
  return experts;
}

#define DEX_INSTANTIATE(T)                                                                         \
  template ActorPass<T> Actor::Carve(std::int64_t, Workspace<T>&) const;                           \
  template void Actor::Forward(const T*, const PolicyRows<Wide<T>>&, const T*, ActorPass<T>&,      \
                               Wide<T>*, Wide<T>*, const int*) const;                              \
  template T* Actor::Backward(const T*, const PolicyRows<Wide<T>>&, ActorPass<T>&, const Wide<T>*, \
                              const Wide<T>*, bool, Wide<T>*) const;
DEX_INSTANTIATE(BFloat16)
DEX_INSTANTIATE(float)
DEX_INSTANTIATE(double)
#undef DEX_INSTANTIATE
template void Actor::Forward(const BFloat16*, const PolicyRows<float>&, const float*,
                             ActorPass<BFloat16>&, float*, float*, const int*) const;

}  // namespace dexremoe
