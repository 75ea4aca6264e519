// Multi-gate mixture of experts (Ma et al. 2018): the tasks are the categories. Experts f_i are
// trunks that all categories share; category k has a gate and a head of its own:
//   g^k = softmax(W_gk e_shape), (mean, value) = h^k(sum_i g^k_i f_i([o, z]))
// The heads are linear, so they are applied to each expert's features and then weighed, which is
// the same. All of it is trained at once, from scratch; no loss of its own.
#pragma once

#include "nn/mlp.h"
#include "policy/category_rows.h"
#include "policy/encoder.h"
#include "policy/policy.h"
#include "policy/value_head.h"

namespace dexremoe {

// Blocks "encoder/*", "expertI/*", "gateC", "headC/*", "log_std".
template <typename T>
class MultiGateMixture final : public Policy<T> {
 public:
  using W = Wide<T>;
  explicit MultiGateMixture(const PolicyStructure& structure);

  void Initialize(std::uint64_t seed, double log_std, double mean_scale,
                  float* params) const override;
  int frozen_size() const override { return 0; }
  void Freeze(const T*, const ShapeInputs<W>&, const PolicyRows<W>&, Workspace<T>&,
              W*) const override {}
  void Forward(const T* params, const ShapeInputs<W>& shapes, const PolicyRows<W>& rows,
               Workspace<T>& work, W* mean, W* value) const override;
  void Backward(const T* params, const ShapeInputs<W>& shapes, const PolicyRows<W>& rows,
                Workspace<T>& work, const W* dmean, const W* dvalue, W* grads) const override;
  bool routes() const override { return true; }
  void Balance(const PolicyRows<W>& rows, const ShapeInputs<W>& shapes, Workspace<T>& work,
               W weight, RoutingSums& sums) const override;
  int gates() const override { return this->structure_.experts; }
  void GateWeights(const T* params, const ShapeInputs<W>& shapes, Workspace<T>& work,
                   W* weights) const override;

 private:
  struct ExpertPass {
    T* trunk;    // activations
    W* out;      // [n, A + 1] of the rows' own heads, without the gate
    T* dhidden;  // [n, hidden]
  };
  struct Pass {
    EncoderPass<T> encoder;
    T* input;  // [o, z] [n, inputs], by category
    std::vector<ExpertPass> experts;
    W *gate_params, *gate_input, *weights;  // [C E columns], [K, columns], [K, E]
    W *dweights, *dshape;                   // [K, E], [K, shape_size]
    W* dz;                                  // [n, z_size], in the order of the rows
    T *dout, *dinput, *dz_stored, *scratch;
  };
  Pass Carve(std::int64_t objects, std::int64_t n, Workspace<T>& work) const;
  void Gate(const T* params, const ShapeInputs<W>& shapes, Pass& pass) const;
  void GateBackward(const ShapeInputs<W>& shapes, Pass& pass, W* grads) const;
  // Heads of expert i; leaves the gradient of its features in dhidden.
  void HeadsBackward(const T* params, int expert, const CategoryRows& sorted,
                     const PolicyRows<W>& rows, Pass& pass, const W* dmean, const W* dvalue,
                     W* grads) const;
  const T* Hidden(const ExpertPass& expert, std::int64_t n) const {
    return expert.trunk + trunks_.front().ActivationSize(n) - n * trunks_.front().outputs();
  }

  Encoder encoder_;
  std::vector<Mlp> trunks_;
  GateColumns columns_;
  std::int64_t gates_begin_;  // offset of the gates, one after the other [E, columns]
  std::vector<ValueHead> heads_;
};

}  // namespace dexremoe
