#include "policy/routed_mixture.h"

#include <algorithm>
#include <numeric>

#include "nn/kernels.h"
#include "policy/sparse_moe.h"
#include "policy/switch_moe.h"

namespace dexremoe {
namespace {

// An expert's rows are filled up to a multiple of this: odd numbers of rows make slow products.
constexpr std::size_t kRowStep = 64;

// Repeats the last row, up to a multiple of kRowStep, as far as `limit` rows go.
void FillUp(std::int64_t limit, std::vector<int>& rows) {
  while (!rows.empty() && rows.size() % kRowStep != 0 &&
         static_cast<std::int64_t>(rows.size()) < limit)
    rows.push_back(rows.back());
}

template <typename W>
std::unique_ptr<Router<W>> MakeRouter(ParamLayout& layout, const PolicyStructure& s) {
  const int inputs = GateColumnsOf(s).size;
  if (s.kind == "switch_moe") return std::make_unique<SwitchRouter<W>>(layout, inputs, s.experts);
  return std::make_unique<NoisyTopK<W>>(layout, inputs, s.experts, s.top_k);
}

}  // namespace

template <typename T>
RoutedMixture<T>::RoutedMixture(const PolicyStructure& s)
    : Policy<T>(s),
      encoder_(this->layout_, s),
      experts_(MakeExperts(this->layout_, s)),
      columns_(GateColumnsOf(s)),
      router_begin_(this->layout_.size()),
      router_(MakeRouter<W>(this->layout_, s)),
      router_size_(this->layout_.size() - router_begin_) {
  this->log_std_block_ = this->layout_.Add("log_std", s.num_actions, 1);
  this->SetTrainable("", true);
}

template <typename T>
void RoutedMixture<T>::Initialize(std::uint64_t seed, double log_std, double mean_scale,
                                  float* params) const {
  Rng rng(seed, Stream::kInit);
  encoder_.Initialize(rng, params);
  for (const Actor& expert : experts_) expert.Initialize(rng, mean_scale, params);
  router_->Initialize(rng, params);
  this->FillLogStd(log_std, params);
}

template <typename T>
typename RoutedMixture<T>::Pass RoutedMixture<T>::Carve(std::int64_t objects, std::int64_t n,
                                                        Workspace<T>& work) const {
  const PolicyStructure& s = this->structure_;
  const auto take = [&](std::int64_t count) { return work.template Take<W>(count); };
  Pass pass;
  pass.encoder = encoder_.Carve(objects, n, work);
  for (const Actor& expert : experts_) pass.experts.push_back(expert.Carve(n, work));
  pass.mean = take(n * s.num_actions);
  pass.value = take(n);
  pass.router_params = take(this->layout_.size() - router_begin_);
  pass.router = take(router_->PassSize(n));
  pass.gate_input = take(n * columns_.size);
  pass.weights = take(n * gates());
  pass.dgate_input = take(n * columns_.size);
  pass.dweights = take(n * gates());
  pass.dmean = take(n * s.num_actions);
  pass.dvalue = take(n);
  pass.dz = take(n * s.z_size);
  pass.dshape = take(objects * s.shape_size());
  pass.dz_stored = work.Take(n * s.z_size);
  return pass;
}

// Needs e_shape.
template <typename T>
void RoutedMixture<T>::Route(const T* params, const PolicyRows<W>& rows, Pass& pass) const {
  const int shape_size = this->structure_.shape_size();
  for (std::int64_t r = 0; r < rows.n; ++r)
    Cast(columns_.size,
         pass.encoder.shape + std::int64_t{rows.object[r]} * shape_size + columns_.begin,
         pass.gate_input + r * columns_.size);
  // The router addresses its blocks by their offsets in the whole array.
  Cast(router_size_, params + router_begin_, pass.router_params);
  router_->Forward(pass.router_params - router_begin_, RowsOfRouter(rows, pass), pass.router,
                   pass.weights);
}

template <typename T>
void RoutedMixture<T>::RowsOf(int expert, std::int64_t n, const W* weights,
                              std::vector<int>& rows) const {
  rows.clear();
  for (std::int64_t r = 0; r < n; ++r)
    if (weights[r * gates() + expert] > 0) rows.push_back(static_cast<int>(r));
}

template <typename T>
void RoutedMixture<T>::Forward(const T* params, const ShapeInputs<W>& shapes,
                               const PolicyRows<W>& rows, Workspace<T>& work, W* mean,
                               W* value) const {
  const int actions = this->structure_.num_actions;
  work.Reset();
  Pass pass = Carve(shapes.objects, rows.n, work);
  encoder_.ShapeForward(params, shapes, pass.encoder);
  const T* z = encoder_.Forward(params, rows, pass.encoder);
  Route(params, rows, pass);
  std::fill_n(mean, rows.n * actions, W(0));
  std::fill_n(value, rows.n, W(0));
  std::vector<int> picked;
  for (int i = 0; i < gates(); ++i) {
    RowsOf(i, rows.n, pass.weights, picked);
    const std::int64_t count = static_cast<std::int64_t>(picked.size());
    if (count == 0) continue;
    FillUp(rows.n, picked);
    PolicyRows<W> ours = rows;
    ours.n = static_cast<std::int64_t>(picked.size());
    experts_[i].Forward(params, ours, z, pass.experts[i], pass.mean, pass.value, picked.data());
    for (std::int64_t m = 0; m < count; ++m) {
      const W w = pass.weights[picked[m] * gates() + i];
      for (int a = 0; a < actions; ++a)
        mean[picked[m] * actions + a] += w * pass.mean[m * actions + a];
      value[picked[m]] += w * pass.value[m];
    }
  }
}

template <typename T>
void RoutedMixture<T>::Balance(const PolicyRows<W>& rows, const ShapeInputs<W>& shapes,
                               Workspace<T>& work, W weight, RoutingSums& sums) const {
  work.Reset();
  const Pass pass = Carve(shapes.objects, rows.n, work);
  const double loss = router_->Balance(RowsOfRouter(rows, pass), pass.weights, weight, pass.router);
  sums.loss += static_cast<double>(rows.n) * loss;
  const W* shares = router_->Shares(rows.n, pass.weights, pass.router);
  AddRouting(rows.n, gates(), pass.weights, shares, sums);
}

template <typename T>
void RoutedMixture<T>::ExpertBackward(const T* params, int expert, const PolicyRows<W>& rows,
                                      Pass& pass, const W* dmean, const W* dvalue, W* grads) const {
  const int actions = this->structure_.num_actions, z_size = this->structure_.z_size;
  std::vector<int> picked;
  RowsOf(expert, rows.n, pass.weights, picked);
  const std::int64_t count = static_cast<std::int64_t>(picked.size());
  if (count == 0) return;
  FillUp(rows.n, picked);
  PolicyRows<W> ours = rows;
  ours.n = static_cast<std::int64_t>(picked.size());
  // Rows that fill up have no gradient, and so add nothing.
  std::fill(pass.dmean + count * actions, pass.dmean + ours.n * actions, W(0));
  std::fill(pass.dvalue + count, pass.dvalue + ours.n, W(0));
  ActorPass<T>& actor = pass.experts[expert];
  for (std::int64_t m = 0; m < count; ++m) {
    const std::int64_t r = picked[m];
    const W* head = actor.head + m * (actions + 1);  // mean and value of Forward
    const W w = pass.weights[r * gates() + expert];
    W& dweight = pass.dweights[r * gates() + expert];
    dweight = dvalue[r] * head[actions];
    for (int a = 0; a < actions; ++a) {
      dweight += dmean[r * actions + a] * head[a];
      pass.dmean[m * actions + a] = w * dmean[r * actions + a];
    }
    pass.dvalue[m] = w * dvalue[r];
  }
  const T* dz =
      experts_[expert].Backward(params, ours, actor, pass.dmean, pass.dvalue, true, grads);
  for (std::int64_t m = 0; m < count; ++m)
    AddTo(z_size, dz + m * z_size, pass.dz + picked[m] * z_size);
}

// Leaves the gradient of e_shape, summed over the rows of each object, in pass.dshape.
template <typename T>
void RoutedMixture<T>::RouterBackward(const ShapeInputs<W>& shapes, const PolicyRows<W>& rows,
                                      Pass& pass, W* grads) const {
  router_->Backward(pass.router_params - router_begin_, RowsOfRouter(rows, pass), pass.weights,
                    pass.dweights, pass.router, pass.dgate_input, grads);
  const int shape_size = this->structure_.shape_size();
  std::fill_n(pass.dshape, shapes.objects * shape_size, W(0));
  for (std::int64_t r = 0; r < rows.n; ++r)
    AddTo(columns_.size, pass.dgate_input + r * columns_.size,
          pass.dshape + std::int64_t{rows.object[r]} * shape_size + columns_.begin);
}

template <typename T>
void RoutedMixture<T>::Backward(const T* params, const ShapeInputs<W>& shapes,
                                const PolicyRows<W>& rows, Workspace<T>& work, const W* dmean,
                                const W* dvalue, W* grads) const {
  work.Reset();
  Pass pass = Carve(shapes.objects, rows.n, work);
  std::fill_n(pass.dz, rows.n * this->structure_.z_size, W(0));
  std::fill_n(pass.dweights, rows.n * gates(), W(0));
  for (int i = 0; i < gates(); ++i) ExpertBackward(params, i, rows, pass, dmean, dvalue, grads);
  RouterBackward(shapes, rows, pass, grads);
  Cast(rows.n * this->structure_.z_size, pass.dz, pass.dz_stored);
  encoder_.Backward(params, shapes, rows, pass.encoder, pass.dz_stored, grads, pass.dshape);
}

template <typename T>
void RoutedMixture<T>::GateWeights(const T* params, const ShapeInputs<W>& shapes,
                                   Workspace<T>& work, W* weights) const {
  std::vector<int> object(shapes.objects);
  std::iota(object.begin(), object.end(), 0);
  PolicyRows<W> rows;
  rows.n = shapes.objects;
  rows.object = object.data();
  work.Reset();
  Pass pass = Carve(shapes.objects, rows.n, work);
  encoder_.ShapeForward(params, shapes, pass.encoder);
  Route(params, rows, pass);
  // Top-1 weights are probabilities of less than one: given here relative to their sum.
  for (std::int64_t k = 0; k < rows.n; ++k) {
    const W* from = pass.weights + k * gates();
    const W sum = std::accumulate(from, from + gates(), W(0));
    for (int i = 0; i < gates(); ++i) weights[k * gates() + i] = from[i] / sum;
  }
}

template class RoutedMixture<BFloat16>;
template class RoutedMixture<float>;
template class RoutedMixture<double>;

}  // namespace dexremoe
