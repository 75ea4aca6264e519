// Soft mixture of experts (paper, III-E, algorithm 1): mean = sum_i w_i(e_shape) mean_i(o, z).
//
// Encoders and experts are frozen; training changes the gate and a value head. As the gate sees the
// object alone, its weights are computed once per object.
//
// NOTE(paper): it does not say what estimates the value while the gate is trained. Here a linear
// layer on the experts' own values and e_shape, started at the plain average of the values: each
// expert's value head is frozen with it, their average is a warm start, and the layer keeps the
// gradient of the value loss away from the gate.
// NOTE(paper): the mixture's spread is silent too. It is the experts' mean log standard deviation
// and stays frozen, as only the gate is to be trained.
#pragma once

#include "nn/mlp.h"
#include "policy/actor.h"
#include "policy/encoder.h"
#include "policy/policy.h"

namespace dexremoe {

// Activations of the gate over the K objects, inside a Workspace.
template <typename T>
struct GatePass {
  T* input;           // [K, inputs]
  T* gate;            // activations
  Wide<T>* weights;   // [K, experts]; first the scores they are the softmax of
  Wide<T>* dweights;  // [K, experts]
  T* dscores;         // [K, experts]
  T* scratch;
};

// Blocks "encoder/*", "expertI/*", "gate/*", "value/*", "log_std". Frozen features of a row: the
// experts' means [experts, A], then their values [experts].
template <typename T>
class SoftMixture final : public Policy<T> {
 public:
  explicit SoftMixture(const PolicyStructure& structure);

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
  bool routes() const override { return true; }
  // Figures alone: the soft gate has no loss of its own.
  void Balance(const PolicyRows<Wide<T>>& rows, const ShapeInputs<Wide<T>>& shapes,
               Workspace<T>& work, Wide<T> weight, RoutingSums& sums) const override;
  int gates() const override { return this->structure_.experts; }
  void GateWeights(const T* params, const ShapeInputs<Wide<T>>& shapes, Workspace<T>& work,
                   Wide<T>* weights) const override;

 private:
  // The buffers of Forward and Backward.
  struct Pass {
    EncoderPass<T> encoder;
    GatePass<T> gate;
    T* value_input;   // [n, experts + shape_size]
    T* dvalue;        // [n]
    Wide<T>* frozen;  // [n, frozen_size()], used when the rows bring none
  };
  Pass Carve(std::int64_t objects, std::int64_t n, Workspace<T>& work) const;
  GatePass<T> CarveGate(std::int64_t objects, Workspace<T>& work) const;
  // Needs e_shape in `shape` [K, shape_size]; fills pass.weights.
  void GateForward(const T* params, std::int64_t objects, const T* shape, GatePass<T>& pass) const;
  void Mix(const PolicyRows<Wide<T>>& rows, const Wide<T>* frozen, const Wide<T>* weights,
           Wide<T>* mean) const;
  void GateBackward(const T* params, std::int64_t objects, const PolicyRows<Wide<T>>& rows,
                    const Wide<T>* frozen, GatePass<T>& pass, const Wide<T>* dmean,
                    Wide<T>* grads) const;

  Encoder encoder_;
  std::vector<Actor> experts_;
  Mlp gate_, value_;
};

}  // namespace dexremoe
