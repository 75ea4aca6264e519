#include "policy/mmoe.h"

#include <algorithm>
#include <numeric>

#include "nn/kernels.h"
#include "nn/layers.h"
#include "policy/router.h"

namespace dexremoe {
namespace {

std::vector<Mlp> MakeTrunks(ParamLayout& layout, const PolicyStructure& s) {
  std::vector<int> widths = {s.obs_size + s.z_size};
  widths.insert(widths.end(), s.hidden.begin(), s.hidden.end());
  std::vector<Mlp> trunks;
  for (int i = 0; i < s.experts; ++i)
    trunks.emplace_back(layout, "expert" + std::to_string(i), widths, true);
  return trunks;
}

std::int64_t AddGates(ParamLayout& layout, const PolicyStructure& s) {
  const std::int64_t begin = layout.size();
  for (int c = 0; c < s.num_categories; ++c)
    layout.Add("gate" + std::to_string(c), s.experts, GateColumnsOf(s).size);
  return begin;
}

std::vector<ValueHead> MakeHeads(ParamLayout& layout, const PolicyStructure& s) {
  std::vector<ValueHead> heads;
  for (int c = 0; c < s.num_categories; ++c)
    heads.emplace_back(layout, "head" + std::to_string(c), s.hidden.back(), s.num_actions);
  return heads;
}

}  // namespace

template <typename T>
MultiGateMixture<T>::MultiGateMixture(const PolicyStructure& s)
    : Policy<T>(s),
      encoder_(this->layout_, s),
      trunks_(MakeTrunks(this->layout_, s)),
      columns_(GateColumnsOf(s)),
      gates_begin_(AddGates(this->layout_, s)),
      heads_(MakeHeads(this->layout_, s)) {
  this->log_std_block_ = this->layout_.Add("log_std", s.num_actions, 1);
  this->SetTrainable("", true);
}

template <typename T>
void MultiGateMixture<T>::Initialize(std::uint64_t seed, double log_std, double mean_scale,
                                     float* params) const {
  Rng rng(seed, Stream::kInit);
  encoder_.Initialize(rng, params);
  for (const Mlp& trunk : trunks_) trunk.Initialize(rng, 1, params);
  // Near the plain average at first, so that no expert is ruled out before it was tried.
  const double bound = 0.01 / std::sqrt(columns_.size);
  for (int i = 0; i < static_cast<int>(heads_.size()) * gates() * columns_.size; ++i)
    params[gates_begin_ + i] = static_cast<float>(rng.Uniform(-bound, bound));
  for (const ValueHead& head : heads_) head.Initialize(rng, mean_scale, params);
  this->FillLogStd(log_std, params);
}

template <typename T>
typename MultiGateMixture<T>::Pass MultiGateMixture<T>::Carve(std::int64_t objects, std::int64_t n,
                                                              Workspace<T>& work) const {
  const PolicyStructure& s = this->structure_;
  const auto wide = [&](std::int64_t count) { return work.template Take<W>(count); };
  const Mlp& trunk = trunks_.front();
  Pass pass;
  pass.encoder = encoder_.Carve(objects, n, work);
  pass.input = work.Take(n * trunk.inputs());
  for (int i = 0; i < gates(); ++i)
    pass.experts.push_back({work.Take(trunk.ActivationSize(n)), wide(n * (s.num_actions + 1)),
                            work.Take(n * trunk.outputs())});
  pass.gate_params = wide(s.num_categories * gates() * columns_.size);
  pass.gate_input = wide(objects * columns_.size);
  pass.weights = wide(objects * gates());
  pass.dweights = wide(objects * gates());
  pass.dshape = wide(objects * s.shape_size());
  pass.dz = wide(n * s.z_size);
  pass.dout = work.Take(n * (s.num_actions + 1));
  pass.dinput = work.Take(n * s.z_size);
  pass.dz_stored = work.Take(n * s.z_size);
  pass.scratch = work.Take(trunk.ScratchSize(n));
  return pass;
}

// Needs e_shape. Every object has one category, and so one gate.
template <typename T>
void MultiGateMixture<T>::Gate(const T* params, const ShapeInputs<W>& shapes, Pass& pass) const {
  const int shape_size = this->structure_.shape_size(), block = gates() * columns_.size;
  const int categories = this->structure_.num_categories;
  const std::vector<int> category = CategoriesOf(shapes, categories);
  Cast(categories * block, params + gates_begin_, pass.gate_params);
  for (std::int64_t k = 0; k < shapes.objects; ++k) {
    W* input = pass.gate_input + k * columns_.size;
    Cast(columns_.size, pass.encoder.shape + k * shape_size + columns_.begin, input);
    RouterScores<W>(1, columns_.size, gates(), input, pass.gate_params + category[k] * block,
                    pass.weights + k * gates());
  }
  SoftmaxForward<W>(shapes.objects, gates(), pass.weights, pass.weights);
}

template <typename T>
void MultiGateMixture<T>::Forward(const T* params, const ShapeInputs<W>& shapes,
                                  const PolicyRows<W>& rows, Workspace<T>& work, W* mean,
                                  W* value) const {
  const PolicyStructure& s = this->structure_;
  const int outputs = s.num_actions + 1, hidden = trunks_.front().outputs();
  work.Reset();
  Pass pass = Carve(shapes.objects, rows.n, work);
  encoder_.ShapeForward(params, shapes, pass.encoder);
  const T* z = encoder_.Forward(params, rows, pass.encoder);
  Gate(params, shapes, pass);
  const CategoryRows sorted =
      SortByCategory(rows, CategoriesOf(shapes, s.num_categories), s.num_categories);
  GatherInput(sorted, rows, s.obs_size, s.z_size, z, pass.input);
  std::fill_n(mean, rows.n * s.num_actions, W(0));
  std::fill_n(value, rows.n, W(0));
  for (int i = 0; i < gates(); ++i) {
    const ExpertPass& expert = pass.experts[i];
    const T* features = trunks_[i].Forward(params, rows.n, pass.input, expert.trunk);
    for (int c = 0; c < s.num_categories; ++c) {
      const std::int64_t first = sorted.begin[c], count = sorted.begin[c + 1] - first;
      if (count > 0)
        heads_[c].Forward(params, count, features + first * hidden, expert.out + first * outputs);
    }
    for (std::int64_t place = 0; place < rows.n; ++place) {
      const std::int64_t r = sorted.order[place];
      const W w = pass.weights[std::int64_t{rows.object[r]} * gates() + i];
      const W* out = expert.out + place * outputs;
      for (int a = 0; a < s.num_actions; ++a) mean[r * s.num_actions + a] += w * out[a];
      value[r] += w * out[s.num_actions];
    }
  }
}

template <typename T>
void MultiGateMixture<T>::Balance(const PolicyRows<W>& rows, const ShapeInputs<W>& shapes,
                                  Workspace<T>& work, W /*weight*/, RoutingSums& sums) const {
  work.Reset();
  const Pass pass = Carve(shapes.objects, rows.n, work);
  for (std::int64_t r = 0; r < rows.n; ++r)
    AddRouting(1, gates(), pass.weights + std::int64_t{rows.object[r]} * gates(), sums);
}

template <typename T>
void MultiGateMixture<T>::HeadsBackward(const T* params, int expert, const CategoryRows& sorted,
                                        const PolicyRows<W>& rows, Pass& pass, const W* dmean,
                                        const W* dvalue, W* grads) const {
  const int actions = this->structure_.num_actions, outputs = actions + 1;
  const int hidden = trunks_.front().outputs();
  const ExpertPass& own = pass.experts[expert];
  std::vector<W> dout(outputs);
  for (std::int64_t place = 0; place < rows.n; ++place) {
    const std::int64_t r = sorted.order[place];
    const std::int64_t gate = std::int64_t{rows.object[r]} * gates() + expert;
    std::copy_n(dmean + r * actions, actions, dout.begin());
    dout[actions] = dvalue[r];
    for (int a = 0; a < outputs; ++a) {
      pass.dweights[gate] += dout[a] * own.out[place * outputs + a];
      dout[a] *= pass.weights[gate];
    }
    Cast(outputs, dout.data(), pass.dout + place * outputs);
  }
  const T* features = Hidden(own, rows.n);
  for (std::size_t c = 0; c < heads_.size(); ++c) {
    const std::int64_t first = sorted.begin[c], count = sorted.begin[c + 1] - first;
    if (count > 0)
      heads_[c].Backward(params, count, features + first * hidden, pass.dout + first * outputs,
                         own.dhidden + first * hidden, grads);
  }
}

template <typename T>
void MultiGateMixture<T>::GateBackward(const ShapeInputs<W>& shapes, Pass& pass, W* grads) const {
  const int shape_size = this->structure_.shape_size(), block = gates() * columns_.size;
  const std::vector<int> category = CategoriesOf(shapes, this->structure_.num_categories);
  SoftmaxBackward<W>(shapes.objects, gates(), pass.weights, pass.dweights, pass.dweights);
  std::fill_n(pass.dshape, shapes.objects * shape_size, W(0));
  for (std::int64_t k = 0; k < shapes.objects; ++k)
    RouterScoresBackward<W>(1, columns_.size, gates(), pass.gate_input + k * columns_.size,
                            pass.gate_params + category[k] * block, pass.dweights + k * gates(),
                            false, pass.dshape + k * shape_size + columns_.begin,
                            grads + gates_begin_ + category[k] * block);
}

template <typename T>
void MultiGateMixture<T>::Backward(const T* params, const ShapeInputs<W>& shapes,
                                   const PolicyRows<W>& rows, Workspace<T>& work, const W* dmean,
                                   const W* dvalue, W* grads) const {
  const PolicyStructure& s = this->structure_;
  work.Reset();
  Pass pass = Carve(shapes.objects, rows.n, work);
  const CategoryRows sorted =
      SortByCategory(rows, CategoriesOf(shapes, s.num_categories), s.num_categories);
  std::fill_n(pass.dweights, shapes.objects * gates(), W(0));
  std::fill_n(pass.dz, rows.n * s.z_size, W(0));
  for (int i = 0; i < gates(); ++i) {
    const ExpertPass& expert = pass.experts[i];
    HeadsBackward(params, i, sorted, rows, pass, dmean, dvalue, grads);
    trunks_[i].Backward(params, rows.n, pass.input, expert.trunk, expert.dhidden, pass.dinput,
                        grads, pass.scratch, s.obs_size);
    for (std::int64_t place = 0; place < rows.n; ++place)
      AddTo(s.z_size, pass.dinput + place * s.z_size,
            pass.dz + std::int64_t{sorted.order[place]} * s.z_size);
  }
  GateBackward(shapes, pass, grads);
  Cast(rows.n * s.z_size, pass.dz, pass.dz_stored);
  encoder_.Backward(params, shapes, rows, pass.encoder, pass.dz_stored, grads, pass.dshape);
}

template <typename T>
void MultiGateMixture<T>::GateWeights(const T* params, const ShapeInputs<W>& shapes,
                                      Workspace<T>& work, W* weights) const {
  work.Reset();
  Pass pass = Carve(shapes.objects, 0, work);
  encoder_.ShapeForward(params, shapes, pass.encoder);
  Gate(params, shapes, pass);
  std::copy_n(pass.weights, shapes.objects * gates(), weights);
}

template class MultiGateMixture<BFloat16>;
template class MultiGateMixture<float>;
template class MultiGateMixture<double>;

}  // namespace dexremoe
