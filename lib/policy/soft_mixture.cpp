#include "policy/soft_mixture.h"

#include <algorithm>

#include "nn/kernels.h"
#include "nn/layers.h"
#include "policy/router.h"

namespace dexremoe {
namespace {

std::vector<int> GateWidths(const PolicyStructure& s) {
  std::vector<int> widths = {GateColumnsOf(s).size};
  widths.insert(widths.end(), s.gate_widths.begin(), s.gate_widths.end());
  widths.push_back(s.experts);
  return widths;
}

}  // namespace

template <typename T>
SoftMixture<T>::SoftMixture(const PolicyStructure& s)
    : Policy<T>(s),
      encoder_(this->layout_, s),
      experts_(MakeExperts(this->layout_, s)),
      gate_(this->layout_, "gate", GateWidths(s), false),
      value_(this->layout_, "value", {s.experts + s.shape_size(), 1}, false) {
  this->log_std_block_ = this->layout_.Add("log_std", s.num_actions, 1);
  this->SetTrainable("", false);
  this->SetTrainable("gate/", !s.gate_uniform);
  this->SetTrainable("value/", true);
}

template <typename T>
void SoftMixture<T>::Initialize(std::uint64_t seed, double log_std, double mean_scale,
                                float* params) const {
  Rng rng(seed, Stream::kInit);
  encoder_.Initialize(rng, params);
  for (const Actor& expert : experts_) expert.Initialize(rng, mean_scale, params);
  // NOTE(paper): initialisation is silent. A last layer of a hundredth starts the gate near the
  // uniform average, so that no expert is ruled out before it was tried.
  gate_.Initialize(rng, 0.01, params);
  const ParamBlock& weight = this->layout_.block(value_.weight(0));
  std::fill_n(params + weight.offset, weight.size(), 0.0f);
  std::fill_n(params + weight.offset, gates(), 1.0f / static_cast<float>(gates()));
  const ParamBlock& bias = this->layout_.block(value_.bias(0));
  params[bias.offset] = 0;
  this->FillLogStd(log_std, params);
}

template <typename T>
int SoftMixture<T>::frozen_size() const {
  return gates() * (this->structure_.num_actions + 1);
}

template <typename T>
void SoftMixture<T>::Freeze(const T* params, const ShapeInputs<Wide<T>>& shapes,
                            const PolicyRows<Wide<T>>& rows, Workspace<T>& work,
                            Wide<T>* frozen) const {
  const int actions = this->structure_.num_actions;
  work.Reset();
  EncoderPass<T> encoder = encoder_.Carve(shapes.objects, rows.n, work);
  ActorPass<T> actor = experts_.front().Carve(rows.n, work);
  Wide<T>* mean = work.template Take<Wide<T>>(rows.n * actions);
  Wide<T>* value = work.template Take<Wide<T>>(rows.n);
  encoder_.ShapeForward(params, shapes, encoder);
  const T* z = encoder_.Forward(params, rows, encoder);
  for (int i = 0; i < gates(); ++i) {
    experts_[i].Forward(params, rows, z, actor, mean, value);
    for (std::int64_t r = 0; r < rows.n; ++r) {
      Wide<T>* row = frozen + r * frozen_size();
      std::copy_n(mean + r * actions, actions, row + i * actions);
      row[gates() * actions + i] = value[r];
    }
  }
}

template <typename T>
GatePass<T> SoftMixture<T>::CarveGate(std::int64_t objects, Workspace<T>& work) const {
  GatePass<T> pass;
  pass.input = work.Take(objects * gate_.inputs());
  pass.gate = work.Take(gate_.ActivationSize(objects));
  pass.weights = work.template Take<Wide<T>>(objects * gates());
  pass.dweights = work.template Take<Wide<T>>(objects * gates());
  pass.dscores = work.Take(objects * gates());
  pass.scratch = work.Take(gate_.ScratchSize(objects));
  return pass;
}

template <typename T>
typename SoftMixture<T>::Pass SoftMixture<T>::Carve(std::int64_t objects, std::int64_t n,
                                                    Workspace<T>& work) const {
  Pass pass;
  pass.encoder = encoder_.Carve(objects, 0, work);
  pass.gate = CarveGate(objects, work);
  pass.value_input = work.Take(n * value_.inputs());
  pass.dvalue = work.Take(n);
  pass.frozen = work.template Take<Wide<T>>(n * frozen_size());
  return pass;
}

template <typename T>
void SoftMixture<T>::GateForward(const T* params, std::int64_t objects, const T* shape,
                                 GatePass<T>& pass) const {
  if (this->structure_.gate_uniform) {
    std::fill_n(pass.weights, objects * gates(), Wide<T>(1) / static_cast<Wide<T>>(gates()));
    return;
  }
  const GateColumns span = GateColumnsOf(this->structure_);
  const int shape_size = this->structure_.shape_size();
  for (std::int64_t k = 0; k < objects; ++k)
    std::copy_n(shape + k * shape_size + span.begin, span.size, pass.input + k * span.size);
  Cast(objects * gates(), gate_.Forward(params, objects, pass.input, pass.gate), pass.weights);
  SoftmaxForward<Wide<T>>(objects, gates(), pass.weights, pass.weights);
}

template <typename T>
void SoftMixture<T>::Mix(const PolicyRows<Wide<T>>& rows, const Wide<T>* frozen,
                         const Wide<T>* weights, Wide<T>* mean) const {
  const int actions = this->structure_.num_actions;
  for (std::int64_t r = 0; r < rows.n; ++r) {
    const Wide<T>* w = weights + std::int64_t{rows.object[r]} * gates();
    const Wide<T>* expert = frozen + r * frozen_size();
    Wide<T>* to = mean + r * actions;
    std::fill_n(to, actions, Wide<T>(0));
    for (int i = 0; i < gates(); ++i, expert += actions)
      for (int a = 0; a < actions; ++a) to[a] += w[i] * expert[a];
  }
}

template <typename T>
void SoftMixture<T>::Forward(const T* params, const ShapeInputs<Wide<T>>& shapes,
                             const PolicyRows<Wide<T>>& rows, Workspace<T>& work, Wide<T>* mean,
                             Wide<T>* value) const {
  std::vector<Wide<T>> own;
  if (rows.frozen == nullptr) {
    own.resize(rows.n * frozen_size());
    Freeze(params, shapes, rows, work, own.data());
  }
  work.Reset();
  Pass pass = Carve(shapes.objects, rows.n, work);
  std::copy(own.begin(), own.end(), pass.frozen);
  const Wide<T>* frozen = rows.frozen != nullptr ? rows.frozen : pass.frozen;
  encoder_.ShapeForward(params, shapes, pass.encoder);
  GateForward(params, shapes.objects, pass.encoder.shape, pass.gate);
  Mix(rows, frozen, pass.gate.weights, mean);
  const int shape_size = this->structure_.shape_size();
  T* input = pass.value_input;
  for (std::int64_t r = 0; r < rows.n; ++r) {
    const Wide<T>* values = frozen + r * frozen_size() + gates() * this->structure_.num_actions;
    Cast(gates(), values, input);
    input += gates();
    input = std::copy_n(pass.encoder.shape + std::int64_t{rows.object[r]} * shape_size, shape_size,
                        input);
  }
  LinearForward<T>(rows.n, value_.inputs(), 1, pass.value_input,
                   params + this->layout_.block(value_.weight(0)).offset,
                   params + this->layout_.block(value_.bias(0)).offset, value);
}

template <typename T>
void SoftMixture<T>::GateBackward(const T* params, std::int64_t objects,
                                  const PolicyRows<Wide<T>>& rows, const Wide<T>* frozen,
                                  GatePass<T>& pass, const Wide<T>* dmean, Wide<T>* grads) const {
  const int actions = this->structure_.num_actions;
  std::fill_n(pass.dweights, objects * gates(), Wide<T>(0));
  for (std::int64_t r = 0; r < rows.n; ++r) {
    const Wide<T>* expert = frozen + r * frozen_size();
    const Wide<T>* from = dmean + r * actions;
    Wide<T>* dw = pass.dweights + std::int64_t{rows.object[r]} * gates();
    for (int i = 0; i < gates(); ++i, expert += actions)
      for (int a = 0; a < actions; ++a) dw[i] += from[a] * expert[a];
  }
  SoftmaxBackward<Wide<T>>(objects, gates(), pass.weights, pass.dweights, pass.dweights);
  Cast(objects * gates(), pass.dweights, pass.dscores);
  gate_.Backward(params, objects, pass.input, pass.gate, pass.dscores, static_cast<T*>(nullptr),
                 grads, pass.scratch);
}

template <typename T>
void SoftMixture<T>::Backward(const T* params, const ShapeInputs<Wide<T>>& shapes,
                              const PolicyRows<Wide<T>>& rows, Workspace<T>& work,
                              const Wide<T>* dmean, const Wide<T>* dvalue, Wide<T>* grads) const {
  work.Reset();
  Pass pass = Carve(shapes.objects, rows.n, work);
  const Wide<T>* frozen = rows.frozen != nullptr ? rows.frozen : pass.frozen;
  if (!this->structure_.gate_uniform)
    GateBackward(params, shapes.objects, rows, frozen, pass.gate, dmean, grads);
  Cast(rows.n, dvalue, pass.dvalue);
  // A single layer needs neither its output nor scratch nor, its inputs being frozen, their
  // gradient.
  value_.Backward(params, rows.n, pass.value_input, pass.dvalue, pass.dvalue,
                  static_cast<T*>(nullptr), grads, static_cast<T*>(nullptr));
}

template <typename T>
void SoftMixture<T>::Balance(const PolicyRows<Wide<T>>& rows, const ShapeInputs<Wide<T>>& shapes,
                             Workspace<T>& work, Wide<T> /*weight*/, RoutingSums& sums) const {
  work.Reset();
  const Pass pass = Carve(shapes.objects, rows.n, work);
  for (std::int64_t r = 0; r < rows.n; ++r)
    AddRouting(1, gates(), pass.gate.weights + std::int64_t{rows.object[r]} * gates(), sums);
}

template <typename T>
void SoftMixture<T>::GateWeights(const T* params, const ShapeInputs<Wide<T>>& shapes,
                                 Workspace<T>& work, Wide<T>* weights) const {
  work.Reset();
  Pass pass = Carve(shapes.objects, 0, work);
  encoder_.ShapeForward(params, shapes, pass.encoder);
  GateForward(params, shapes.objects, pass.encoder.shape, pass.gate);
  std::copy_n(pass.gate.weights, shapes.objects * gates(), weights);
}

template class SoftMixture<BFloat16>;
template class SoftMixture<float>;
template class SoftMixture<double>;

}  // namespace dexremoe
