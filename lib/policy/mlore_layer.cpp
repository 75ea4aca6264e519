#include "policy/mlore_layer.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "nn/kernels.h"
#include "nn/layers.h"
#include "policy/router.h"

namespace dexremoe {

MloreLayer::MloreLayer(ParamLayout& layout, const std::string& name, int inputs, int outputs,
                       const PolicyStructure& s)
    : inputs_(inputs),
      outputs_(outputs),
      gate_inputs_(GateColumnsOf(s).size),
      top_k_(s.top_k),
      rank_(std::accumulate(s.ranks.begin(), s.ranks.end(), 0)),
      category_rank_(s.category_rank),
      categories_(s.num_categories),
      ranks_(s.ranks) {
  const auto add = [&](const std::string& block, int rows, int columns) {
    return layout.block(layout.Add(name + "/" + block, rows, columns)).offset;
  };
  shared_ = add("shared/weight", outputs, inputs);
  bias_ = add("shared/bias", outputs, 1);
  down_ = add("down", rank_, inputs);
  up_ = add("up", outputs, rank_);
  for (int c = 0; c < categories_; ++c) {
    const std::string own = "category" + std::to_string(c);
    category_down_.push_back(add(own + "/down", category_rank_, inputs));
    category_up_.push_back(add(own + "/up", outputs, category_rank_));
  }
  router_ = add("router", experts(), gate_inputs_);
}

void MloreLayer::InitializeBlock(Rng& rng, std::int64_t offset, int rows, int columns,
                                 float* params) const {
  const double bound = 1 / std::sqrt(columns);
  for (std::int64_t i = 0; i < std::int64_t{rows} * columns; ++i)
    params[offset + i] = static_cast<float>(rng.Uniform(-bound, bound));
}

void MloreLayer::Initialize(Rng& rng, float* params) const {
  InitializeBlock(rng, shared_, outputs_, inputs_, params);
  std::fill_n(params + bias_, outputs_, 0.0f);
  InitializeBlock(rng, down_, rank_, inputs_, params);
  InitializeBlock(rng, up_, outputs_, rank_, params);
  for (int c = 0; c < categories_; ++c) {
    InitializeBlock(rng, category_down_[c], category_rank_, inputs_, params);
    InitializeBlock(rng, category_up_[c], outputs_, category_rank_, params);
  }
  InitializeBlock(rng, router_, experts(), gate_inputs_, params);
}

template <typename T>
MloreLayerPass<T> MloreLayer::Carve(std::int64_t n, Workspace<T>& work) const {
  const auto wide = [&](std::int64_t count) { return work.template Take<Wide<T>>(count); };
  const int widest = std::max({rank_, category_rank_, outputs_});
  MloreLayerPass<T> pass;
  pass.router_params = wide(experts() * gate_inputs_);
  pass.probability = wide(n * experts());
  pass.weights = wide(n * experts());
  pass.dprobability = wide(n * experts());
  pass.low = work.Take(n * rank_);
  pass.own = work.Take(n * category_rank_);
  pass.out = work.Take(n * outputs_);
  pass.low_wide = wide(n * rank_);
  pass.part = wide(n * std::max(outputs_, category_rank_));
  pass.sum = wide(n * outputs_);
  pass.bias_gradient = wide(widest);
  pass.zero = work.Take(widest);
  pass.dlow = work.Take(n * rank_);
  pass.down = work.Take(n * category_rank_);
  pass.dx = work.Take(n * inputs_);
  return pass;
}

template <typename T>
void MloreLayer::Route(const T* params, std::int64_t n, const Wide<T>* gate_input,
                       const Wide<T>* noise, MloreLayerPass<T>& pass) const {
  using W = Wide<T>;
  Cast(experts() * gate_inputs_, params + router_, pass.router_params);
  RouterScores<W>(n, gate_inputs_, experts(), gate_input, pass.router_params, pass.probability);
  for (std::int64_t e = 0; noise != nullptr && e < n * experts(); ++e)
    pass.probability[e] += noise[e] / static_cast<W>(experts());
  SoftmaxForward<W>(n, experts(), pass.probability, pass.probability);
  std::fill_n(pass.weights, n * experts(), W(0));
  std::fill_n(pass.dprobability, n * experts(), W(0));
  std::vector<int> order;
  for (std::int64_t row = 0; row < n * experts(); row += experts()) {
    SortScores(experts(), pass.probability + row, order);
    for (int j = 0; j < top_k_; ++j)
      pass.weights[row + order[j]] = pass.probability[row + order[j]];
  }
}

template <typename T>
const T* MloreLayer::Forward(const T* params, const CategoryRows& sorted, const T* x,
                             const Wide<T>* gate_input, const Wide<T>* noise,
                             MloreLayerPass<T>& pass) const {
  const std::int64_t n = static_cast<std::int64_t>(sorted.order.size());
  std::fill_n(pass.zero, std::max({rank_, category_rank_, outputs_}), T());
  Route(params, n, gate_input, noise, pass);
  LinearForward<T>(n, inputs_, outputs_, x, params + shared_, params + bias_, pass.sum);
  LinearForward<T>(n, inputs_, rank_, x, params + down_, pass.zero, pass.low_wide);
  std::vector<Wide<T>> weighed(rank_);
  for (std::int64_t r = 0; r < n; ++r) {
    const Wide<T>* from = pass.low_wide + r * rank_;
    int j = 0;
    for (int i = 0; i < experts(); ++i)
      for (const int end = j + ranks_[i]; j < end; ++j)
        weighed[j] = pass.weights[r * experts() + i] * from[j];
    Cast(rank_, weighed.data(), pass.low + r * rank_);
  }
  LinearForward<T>(n, rank_, outputs_, pass.low, params + up_, pass.zero, pass.part);
  AddTo(n * outputs_, pass.part, pass.sum);
  AddCategoryPaths(params, sorted, x, pass);
  EluForward<Wide<T>>(n * outputs_, pass.sum, pass.sum);
  Cast(n * outputs_, pass.sum, pass.out);
  return pass.out;
}

template <typename T>
void MloreLayer::AddCategoryPaths(const T* params, const CategoryRows& sorted, const T* x,
                                  MloreLayerPass<T>& pass) const {
  for (int c = 0; c < categories_; ++c) {
    const std::int64_t first = sorted.begin[c], count = sorted.begin[c + 1] - first;
    if (count == 0) continue;
    T* own = pass.own + first * category_rank_;
    LinearForward<T>(count, inputs_, category_rank_, x + first * inputs_,
                     params + category_down_[c], pass.zero, pass.part);
    Cast(count * category_rank_, pass.part, own);
    LinearForward<T>(count, category_rank_, outputs_, own, params + category_up_[c], pass.zero,
                     pass.part);
    AddTo(count * outputs_, pass.part, pass.sum + first * outputs_);
  }
}

template <typename T>
double MloreLayer::Balance(std::int64_t n, Wide<T> weight, MloreLayerPass<T>& pass) const {
  std::vector<Wide<T>> importance(experts(), Wide<T>(0)), gradient;
  for (std::int64_t e = 0; e < n * experts(); ++e) importance[e % experts()] += pass.probability[e];
  const double loss = kBalanceWeight * SquaredVariation(importance, gradient);
  for (std::int64_t e = 0; e < n * experts(); ++e)
    pass.dprobability[e] += weight * static_cast<Wide<T>>(kBalanceWeight) * gradient[e % experts()];
  return loss;
}

template <typename T>
void MloreLayer::WeighBackward(std::int64_t n, MloreLayerPass<T>& pass) const {
  std::vector<Wide<T>> d(rank_);
  for (std::int64_t r = 0; r < n; ++r) {
    Cast(rank_, pass.dlow + r * rank_, d.data());
    const Wide<T>* low = pass.low_wide + r * rank_;
    int j = 0;
    for (int i = 0; i < experts(); ++i) {
      const std::int64_t e = r * experts() + i;
      Wide<T> inner = 0;
      for (const int end = j + ranks_[i]; j < end; ++j) {
        inner += d[j] * low[j];
        d[j] *= pass.weights[e];
      }
      if (pass.weights[e] > 0) pass.dprobability[e] += inner;
    }
    Cast(rank_, d.data(), pass.dlow + r * rank_);
  }
}

template <typename T>
void MloreLayer::CategoryBackward(const T* params, const CategoryRows& sorted, const T* x,
                                  MloreLayerPass<T>& pass, const T* dy, Wide<T>* dx,
                                  Wide<T>* grads) const {
  for (int c = 0; c < categories_; ++c) {
    const std::int64_t first = sorted.begin[c], count = sorted.begin[c + 1] - first;
    if (count == 0) continue;
    LinearBackward<T>(count, category_rank_, outputs_, pass.own + first * category_rank_,
                      params + category_up_[c], dy + first * outputs_, pass.down,
                      grads + category_up_[c], pass.bias_gradient);
    LinearBackward<T>(count, inputs_, category_rank_, x + first * inputs_,
                      params + category_down_[c], pass.down, pass.dx, grads + category_down_[c],
                      pass.bias_gradient);
    AddTo(count * inputs_, pass.dx, dx + first * inputs_);
  }
}

template <typename T>
void MloreLayer::Backward(const T* params, const CategoryRows& sorted, const T* x,
                          const Wide<T>* gate_input, MloreLayerPass<T>& pass, T* dy, Wide<T>* dx,
                          Wide<T>* dgate_input, Wide<T>* grads) const {
  using W = Wide<T>;
  const std::int64_t n = static_cast<std::int64_t>(sorted.order.size());
  ActivationBackward<T>(Activation::kElu, n * outputs_, pass.out, dy, dy);
  LinearBackward<T>(n, inputs_, outputs_, x, params + shared_, dy, pass.dx, grads + shared_,
                    grads + bias_);
  AddTo(n * inputs_, pass.dx, dx);
  LinearBackward<T>(n, rank_, outputs_, pass.low, params + up_, dy, pass.dlow, grads + up_,
                    pass.bias_gradient);
  WeighBackward(n, pass);
  LinearBackward<T>(n, inputs_, rank_, x, params + down_, pass.dlow, pass.dx, grads + down_,
                    pass.bias_gradient);
  AddTo(n * inputs_, pass.dx, dx);
  CategoryBackward(params, sorted, x, pass, dy, dx, grads);
  SoftmaxBackward<W>(n, experts(), pass.probability, pass.dprobability, pass.dprobability);
  std::vector<W> dgate(n * gate_inputs_);
  RouterScoresBackward<W>(n, gate_inputs_, experts(), gate_input, pass.router_params,
                          pass.dprobability, false, dgate.data(), grads + router_);
  AddTo(n * gate_inputs_, dgate.data(), dgate_input);
}

#define DEX_INSTANTIATE(T)                                                                       \
  template MloreLayerPass<T> MloreLayer::Carve(std::int64_t, Workspace<T>&) const;               \
  template const T* MloreLayer::Forward(const T*, const CategoryRows&, const T*, const Wide<T>*, \
                                        const Wide<T>*, MloreLayerPass<T>&) const;               \
  template double MloreLayer::Balance(std::int64_t, Wide<T>, MloreLayerPass<T>&) const;          \
  template void MloreLayer::Backward(const T*, const CategoryRows&, const T*, const Wide<T>*,    \
                                     MloreLayerPass<T>&, T*, Wide<T>*, Wide<T>*, Wide<T>*) const;
DEX_INSTANTIATE(BFloat16)
DEX_INSTANTIATE(float)
DEX_INSTANTIATE(double)
#undef DEX_INSTANTIATE

}  // namespace dexremoe
