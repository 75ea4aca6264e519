// A policy whose trunk is made of MLoRE layers (mlore_layer.h), with one head; the tasks are the
// categories. All of it is trained at once, from scratch.
#pragma once

#include "policy/encoder.h"
#include "policy/mlore_layer.h"
#include "policy/policy.h"
#include "policy/value_head.h"

namespace dexremoe {

// Blocks "encoder/*", "layerL/*", "head/*", "log_std".
template <typename T>
class LowRankMixture final : public Policy<T> {
 public:
  using W = Wide<T>;
  explicit LowRankMixture(const PolicyStructure& structure);

  void Initialize(std::uint64_t seed, double log_std, double mean_scale,
                  float* params) const override;
  int frozen_size() const override { return 0; }
  void Freeze(const T*, const ShapeInputs<W>&, const PolicyRows<W>&, Workspace<T>&,
              W*) const override {}
  void Forward(const T* params, const ShapeInputs<W>& shapes, const PolicyRows<W>& rows,
               Workspace<T>& work, W* mean, W* value) const override;
  void Backward(const T* params, const ShapeInputs<W>& shapes, const PolicyRows<W>& rows,
                Workspace<T>& work, const W* dmean, const W* dvalue, W* grads) const override;
  int noise_size() const override {
    return static_cast<int>(layers_.size()) * this->structure_.experts;
  }
  void DrawNoise(Rng& rng, float* noise) const override;
  bool routes() const override { return true; }
  // Entropy and load are means over the layers, the loss their sum.
  void Balance(const PolicyRows<W>& rows, const ShapeInputs<W>& shapes, Workspace<T>& work,
               W weight, RoutingSums& sums) const override;

 private:
  struct Pass {
    EncoderPass<T> encoder;
    T* input;  // [o, z] [n, inputs]; like all below but dz in order of the categories
    std::vector<MloreLayerPass<T>> layers;
    W *gate_input, *dgate_input;  // [n, columns]
    std::vector<W*> noise;        // per layer [n, E]
    W *head, *dx;                 // [n, A + 1]; [n, widest]
    T *dhead, *dy, *dz;           // [n, A + 1]; [n, widest]; [n, z_size]
    W* dshape;                    // [K, shape_size]
  };
  Pass Carve(std::int64_t objects, std::int64_t n, Workspace<T>& work) const;
  CategoryRows Sort(const ShapeInputs<W>& shapes, const PolicyRows<W>& rows) const;
  void GatherGate(const CategoryRows& sorted, const PolicyRows<W>& rows, Pass& pass) const;
  void HeadBackward(const T* params, const CategoryRows& sorted, Pass& pass, const W* dmean,
                    const W* dvalue, W* grads) const;
  // Gradients of z and e_shape, back in order of the rows and summed over each object's.
  void ScatterInputs(const CategoryRows& sorted, const ShapeInputs<W>& shapes,
                     const PolicyRows<W>& rows, Pass& pass) const;

  Encoder encoder_;
  std::vector<MloreLayer> layers_;
  ValueHead head_;
  GateColumns columns_;
  int widest_;
};

}  // namespace dexremoe
