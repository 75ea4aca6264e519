#include "policy/mlore.h"

#include <algorithm>

#include "nn/kernels.h"
#include "policy/router.h"

namespace dexremoe {
namespace {

std::vector<MloreLayer> MakeLayers(ParamLayout& layout, const PolicyStructure& s) {
  std::vector<MloreLayer> layers;
  int inputs = s.obs_size + s.z_size;
  for (const int width : s.hidden) {
    layers.emplace_back(layout, "layer" + std::to_string(layers.size()), inputs, width, s);
    inputs = width;
  }
  return layers;
}

}  // namespace

template <typename T>
LowRankMixture<T>::LowRankMixture(const PolicyStructure& s)
    : Policy<T>(s),
      encoder_(this->layout_, s),
      layers_(MakeLayers(this->layout_, s)),
      head_(this->layout_, "head", s.hidden.back(), s.num_actions),
      columns_(GateColumnsOf(s)),
      widest_(
          std::max(s.obs_size + s.z_size, *std::max_element(s.hidden.begin(), s.hidden.end()))) {
  this->log_std_block_ = this->layout_.Add("log_std", s.num_actions, 1);
  this->SetTrainable("", true);
}

template <typename T>
void LowRankMixture<T>::Initialize(std::uint64_t seed, double log_std, double mean_scale,
                                   float* params) const {
  Rng rng(seed, Stream::kInit);
  encoder_.Initialize(rng, params);
  for (const MloreLayer& layer : layers_) layer.Initialize(rng, params);
  head_.Initialize(rng, mean_scale, params);
  this->FillLogStd(log_std, params);
}

template <typename T>
void LowRankMixture<T>::DrawNoise(Rng& rng, float* noise) const {
  for (int i = 0; i < noise_size(); ++i) noise[i] = static_cast<float>(rng.Normal());
}

template <typename T>
typename LowRankMixture<T>::Pass LowRankMixture<T>::Carve(std::int64_t objects, std::int64_t n,
                                                          Workspace<T>& work) const {
  const PolicyStructure& s = this->structure_;
  const auto wide = [&](std::int64_t count) { return work.template Take<W>(count); };
  Pass pass;
  pass.encoder = encoder_.Carve(objects, n, work);
  pass.input = work.Take(n * (s.obs_size + s.z_size));
  for (const MloreLayer& layer : layers_) {
    pass.layers.push_back(layer.Carve(n, work));
    pass.noise.push_back(wide(n * s.experts));
  }
  pass.gate_input = wide(n * columns_.size);
  pass.dgate_input = wide(n * columns_.size);
  pass.head = wide(n * head_.outputs());
  pass.dx = wide(n * widest_);
  pass.dhead = work.Take(n * head_.outputs());
  pass.dy = work.Take(n * widest_);
  pass.dz = work.Take(n * s.z_size);
  pass.dshape = wide(objects * s.shape_size());
  return pass;
}

template <typename T>
CategoryRows LowRankMixture<T>::Sort(const ShapeInputs<W>& shapes,
                                     const PolicyRows<W>& rows) const {
  const int categories = this->structure_.num_categories;
  return SortByCategory(rows, CategoriesOf(shapes, categories), categories);
}

// Needs e_shape.
template <typename T>
void LowRankMixture<T>::GatherGate(const CategoryRows& sorted, const PolicyRows<W>& rows,
                                   Pass& pass) const {
  const int shape_size = this->structure_.shape_size(), experts = this->structure_.experts;
  for (std::int64_t place = 0; place < rows.n; ++place) {
    const std::int64_t r = sorted.order[place];
    Cast(columns_.size,
         pass.encoder.shape + std::int64_t{rows.object[r]} * shape_size + columns_.begin,
         pass.gate_input + place * columns_.size);
    for (std::size_t l = 0; rows.noise != nullptr && l < layers_.size(); ++l)
      std::copy_n(rows.noise + r * noise_size() + static_cast<int>(l) * experts, experts,
                  pass.noise[l] + place * experts);
  }
}

template <typename T>
void LowRankMixture<T>::Forward(const T* params, const ShapeInputs<W>& shapes,
                                const PolicyRows<W>& rows, Workspace<T>& work, W* mean,
                                W* value) const {
  const PolicyStructure& s = this->structure_;
  work.Reset();
  Pass pass = Carve(shapes.objects, rows.n, work);
  const CategoryRows sorted = Sort(shapes, rows);
  encoder_.ShapeForward(params, shapes, pass.encoder);
  const T* z = encoder_.Forward(params, rows, pass.encoder);
  GatherInput(sorted, rows, s.obs_size, s.z_size, z, pass.input);
  GatherGate(sorted, rows, pass);
  const T* x = pass.input;
  for (std::size_t l = 0; l < layers_.size(); ++l)
    x = layers_[l].Forward(params, sorted, x, pass.gate_input,
                           rows.noise != nullptr ? pass.noise[l] : nullptr, pass.layers[l]);
  head_.Forward(params, rows.n, x, pass.head);
  for (std::int64_t place = 0; place < rows.n; ++place) {
    const std::int64_t r = sorted.order[place];
    const W* out = pass.head + place * head_.outputs();
    std::copy_n(out, s.num_actions, mean + r * s.num_actions);
    value[r] = out[s.num_actions];
  }
}

template <typename T>
void LowRankMixture<T>::Balance(const PolicyRows<W>& rows, const ShapeInputs<W>& shapes,
                                Workspace<T>& work, W weight, RoutingSums& sums) const {
  work.Reset();
  Pass pass = Carve(shapes.objects, rows.n, work);
  RoutingSums all;
  for (std::size_t l = 0; l < layers_.size(); ++l) {
    sums.loss += static_cast<double>(rows.n) * layers_[l].Balance(rows.n, weight, pass.layers[l]);
    AddRouting(rows.n, layers_[l].experts(), pass.layers[l].weights, all);
  }
  const double count = static_cast<double>(layers_.size());
  sums.entropy += all.entropy / count;
  sums.load.resize(all.load.size(), 0.0);
  for (std::size_t i = 0; i < all.load.size(); ++i) sums.load[i] += all.load[i] / count;
}

template <typename T>
void LowRankMixture<T>::HeadBackward(const T* params, const CategoryRows& sorted, Pass& pass,
                                     const W* dmean, const W* dvalue, W* grads) const {
  const int actions = this->structure_.num_actions;
  T* dhead = pass.dhead;
  for (const int r : sorted.order) {
    Cast(actions, dmean + std::int64_t{r} * actions, dhead);
    Cast(1, dvalue + r, dhead + actions);
    dhead += head_.outputs();
  }
  head_.Backward(params, static_cast<std::int64_t>(sorted.order.size()), pass.layers.back().out,
                 pass.dhead, pass.dy, grads);
}

template <typename T>
void LowRankMixture<T>::ScatterInputs(const CategoryRows& sorted, const ShapeInputs<W>& shapes,
                                      const PolicyRows<W>& rows, Pass& pass) const {
  const PolicyStructure& s = this->structure_;
  std::fill_n(pass.dshape, shapes.objects * s.shape_size(), W(0));
  for (std::int64_t place = 0; place < rows.n; ++place) {
    const std::int64_t r = sorted.order[place];
    const W* dx = pass.dx + place * (s.obs_size + s.z_size);
    Cast(s.z_size, dx + s.obs_size, pass.dz + r * s.z_size);
    AddTo(columns_.size, pass.dgate_input + place * columns_.size,
          pass.dshape + std::int64_t{rows.object[r]} * s.shape_size() + columns_.begin);
  }
}

template <typename T>
void LowRankMixture<T>::Backward(const T* params, const ShapeInputs<W>& shapes,
                                 const PolicyRows<W>& rows, Workspace<T>& work, const W* dmean,
                                 const W* dvalue, W* grads) const {
  work.Reset();
  Pass pass = Carve(shapes.objects, rows.n, work);
  const CategoryRows sorted = Sort(shapes, rows);
  HeadBackward(params, sorted, pass, dmean, dvalue, grads);
  std::fill_n(pass.dgate_input, rows.n * columns_.size, W(0));
  for (int l = static_cast<int>(layers_.size()) - 1; l >= 0; --l) {
    const std::int64_t size = rows.n * layers_[l].inputs();
    std::fill_n(pass.dx, size, W(0));
    layers_[l].Backward(params, sorted, l > 0 ? pass.layers[l - 1].out : pass.input,
                        pass.gate_input, pass.layers[l], pass.dy, pass.dx, pass.dgate_input, grads);
    if (l > 0) Cast(size, pass.dx, pass.dy);
  }
  ScatterInputs(sorted, shapes, rows, pass);
  encoder_.Backward(params, shapes, rows, pass.encoder, pass.dz, grads, pass.dshape);
}

template class LowRankMixture<BFloat16>;
template class LowRankMixture<float>;
template class LowRankMixture<double>;

}  // namespace dexremoe
