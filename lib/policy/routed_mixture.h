// Sparse mixtures: an encoder, experts that are whole actors, and a router that lets a few of them
// act on each row: mean and value are sum_i w_i (mean_i, value_i). All of it is trained at once,
// from scratch. An expert works on the rows that come to it and on no others.
//
// NOTE(paper): what the routers of its baselines look at is not said. Here e_shape, as the gate of
// the paper's own method does, or the part of it that structure.gate_input names.
#pragma once

#include "policy/actor.h"
#include "policy/encoder.h"
#include "policy/policy.h"
#include "policy/router.h"

namespace dexremoe {

// Blocks "encoder/*", "expertI/*", "router/*", "log_std". structure.kind names the router.
template <typename T>
class RoutedMixture final : public Policy<T> {
 public:
  using W = Wide<T>;
  explicit RoutedMixture(const PolicyStructure& structure);

  void Initialize(std::uint64_t seed, double log_std, double mean_scale,
                  float* params) const override;
  int frozen_size() const override { return 0; }
  void Freeze(const T*, const ShapeInputs<W>&, const PolicyRows<W>&, Workspace<T>&,
              W*) const override {}
  void Forward(const T* params, const ShapeInputs<W>& shapes, const PolicyRows<W>& rows,
               Workspace<T>& work, W* mean, W* value) const override;
  void Backward(const T* params, const ShapeInputs<W>& shapes, const PolicyRows<W>& rows,
                Workspace<T>& work, const W* dmean, const W* dvalue, W* grads) const override;

  int noise_size() const override { return router_->noise_size(); }
  void DrawNoise(Rng& rng, float* noise) const override { router_->DrawNoise(rng, noise); }
  bool routes() const override { return true; }
  void Balance(const PolicyRows<W>& rows, const ShapeInputs<W>& shapes, Workspace<T>& work,
               W weight, RoutingSums& sums) const override;
  int gates() const override { return this->structure_.experts; }
  void GateWeights(const T* params, const ShapeInputs<W>& shapes, Workspace<T>& work,
                   W* weights) const override;

 private:
  struct Pass {
    EncoderPass<T> encoder;
    std::vector<ActorPass<T>> experts;
    W *mean, *value;            // of one expert's rows
    W *router_params, *router;  // the router's blocks; what it keeps
    W *gate_input, *weights;    // [n, columns], [n, E]
    W *dgate_input, *dweights;
    W *dmean, *dvalue, *dz;  // of one expert's rows; [n, z_size] of all
    W* dshape;               // [K, shape_size]
    T* dz_stored;
  };
  Pass Carve(std::int64_t objects, std::int64_t n, Workspace<T>& work) const;
  RouterRows<W> RowsOfRouter(const PolicyRows<W>& rows, const Pass& pass) const {
    return {rows.n, pass.gate_input, rows.noise};
  }
  void Route(const T* params, const PolicyRows<W>& rows, Pass& pass) const;
  // Rows on which the expert acts, in order.
  void RowsOf(int expert, std::int64_t n, const W* weights, std::vector<int>& rows) const;
  void ExpertBackward(const T* params, int expert, const PolicyRows<W>& rows, Pass& pass,
                      const W* dmean, const W* dvalue, W* grads) const;
  void RouterBackward(const ShapeInputs<W>& shapes, const PolicyRows<W>& rows, Pass& pass,
                      W* grads) const;

  Encoder encoder_;
  std::vector<Actor> experts_;
  GateColumns columns_;
  std::int64_t router_begin_;
  std::unique_ptr<Router<W>> router_;
  std::int64_t router_size_;
};

}  // namespace dexremoe
