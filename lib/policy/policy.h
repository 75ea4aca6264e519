// The one interface behind which all policies stand.
//
// A policy is a constant structure over one flat parameter array (nn/params.h): it holds no
// numbers. T is what it stores parameters and activations in: float or BFloat16 to train, double to
// check gradients. Inputs, outputs and gradients are Wide<T>: float for both of the former. Shapes:
// n rows, K objects, A actions.
//
// It has two halves. What no trainable parameter enters (frozen encoders, frozen experts) is the
// frozen features of a row: computed once when the row is collected and handed back to every pass
// of the update. The rest is Forward and Backward.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/random.h"
#include "nn/bfloat16.h"
#include "nn/params.h"
#include "policy/structure.h"
#include "policy/workspace.h"

namespace dexremoe {

// Constant inputs of every object of the table. Whatever depends on them alone is computed once per
// object, not per row.
template <typename T>
struct ShapeInputs {
  std::int64_t objects = 0;
  const T* feature = nullptr;   // [K, feature_size], normalised
  const T* category = nullptr;  // [K, num_categories], one-hot
};

template <typename T>
struct PolicyRows {
  std::int64_t n = 0;
  const T* obs = nullptr;       // [n, obs_size], normalised
  const T* phys = nullptr;      // [n, phys_size], normalised
  const int* object = nullptr;  // [n], into ShapeInputs
  const T* frozen = nullptr;    // [n, frozen_size()], or null to have them computed
  const T* noise = nullptr;     // [n, noise_size()], or null to route without noise
};

// How a mixture used its experts on some rows; sums over the rows, to be added up.
struct RoutingSums {
  double loss = 0;           // the policy's own losses, weighted as in training
  double entropy = 0;        // nats, of the weights; of Switch, of its probabilities
  std::vector<double> load;  // [experts]: rows weighed by the expert's weight
  void Add(const RoutingSums& other) {
    loss += other.loss;
    entropy += other.entropy;
    load.resize(other.load.size(), 0.0);
    for (std::size_t i = 0; i < load.size(); ++i) load[i] += other.load[i];
  }
};

template <typename T>
class Policy {
 public:
  using W = Wide<T>;
  virtual ~Policy() = default;

  const PolicyStructure& structure() const { return structure_; }
  const ParamLayout& layout() const { return layout_; }
  // Per block of the layout: 1 when training may change it.
  const std::vector<std::uint8_t>& trainable() const { return trainable_; }
  // Block "log_std" [A, 1]: the state-independent spread of the actions.
  int log_std_block() const { return log_std_block_; }

  // Fresh parameters. `params` has layout().size() elements.
  virtual void Initialize(std::uint64_t seed, double log_std, double mean_scale,
                          float* params) const = 0;

  // Numbers per row that depend on frozen parameters only.
  virtual int frozen_size() const = 0;
  // frozen [n, frozen_size()] is set.
  virtual void Freeze(const T* params, const ShapeInputs<W>& shapes, const PolicyRows<W>& rows,
                      Workspace<T>& work, W* frozen) const = 0;

  // mean [n, A] and value [n] are set.
  virtual void Forward(const T* params, const ShapeInputs<W>& shapes, const PolicyRows<W>& rows,
                       Workspace<T>& work, W* mean, W* value) const = 0;
  // After Forward with the same arguments: adds the gradients of trainable blocks to `grads`, which
  // is laid out like `params`; other blocks are not touched. dmean [n, A], dvalue [n].
  virtual void Backward(const T* params, const ShapeInputs<W>& shapes, const PolicyRows<W>& rows,
                        Workspace<T>& work, const W* dmean, const W* dvalue, W* grads) const = 0;

  // Random numbers per row that routing draws in training; 0 without. They belong to the row as its
  // action does: the update must see the routing that acted.
  virtual int noise_size() const { return 0; }
  // noise [noise_size()] is set.
  virtual void DrawNoise(Rng& /*rng*/, float* /*noise*/) const {}
  // Whether training must call Balance.
  virtual bool routes() const { return false; }
  // Losses of the policy's own that PPO's is to have added (load balancing), over these rows as one
  // group. Between Forward and Backward with the same arguments: adds to `sums` and lets Backward
  // add `weight` times their gradient.
  virtual void Balance(const PolicyRows<W>& /*rows*/, const ShapeInputs<W>& /*shapes*/,
                       Workspace<T>& /*work*/, W /*weight*/, RoutingSums& /*sums*/) const {}

  // Experts behind a gate; 0 without one.
  virtual int gates() const { return 0; }
  // weights [K, gates()] is set.
  virtual void GateWeights(const T* /*params*/, const ShapeInputs<W>& /*shapes*/,
                           Workspace<T>& /*work*/, W* /*weights*/) const {}

 protected:
  explicit Policy(PolicyStructure structure) : structure_(std::move(structure)) {}
  // Marks the blocks whose names start with `prefix`.
  void SetTrainable(const std::string& prefix, bool on) {
    trainable_.resize(layout_.blocks().size(), 0);
    for (std::size_t i = 0; i < trainable_.size(); ++i)
      if (layout_.block(static_cast<int>(i)).name.starts_with(prefix)) trainable_[i] = on;
  }

  void FillLogStd(double log_std, float* params) const {
    const ParamBlock& block = layout_.block(log_std_block_);
    std::fill_n(params + block.offset, block.size(), static_cast<float>(log_std));
  }

  PolicyStructure structure_;
  ParamLayout layout_;
  std::vector<std::uint8_t> trainable_;
  int log_std_block_ = -1;
};

// Builds the policy named in structure.kind. Throws Error for an unknown kind or sizes that make
// no network.
template <typename T>
std::unique_ptr<Policy<T>> MakePolicy(const PolicyStructure& structure);

}  // namespace dexremoe
