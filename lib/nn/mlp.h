// A stack of linear layers with an activation between them (and after the last, when asked for).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/random.h"
#include "nn/layers.h"
#include "nn/params.h"

namespace dexremoe {

class Mlp {
 public:
  // widths = {inputs, hidden..., outputs}; adds "name/0/weight" [k,c] and "name/0/bias" [k] ... to
  // the layout.
  Mlp(ParamLayout& layout, const std::string& name, std::vector<int> widths, bool activate_end,
      Activation activation = Activation::kElu);

  int inputs() const { return widths_.front(); }
  int outputs() const { return widths_.back(); }
  int layers() const { return static_cast<int>(widths_.size()) - 1; }
  // Elements of the activation buffer for n rows (all layer outputs, one after the other).
  std::int64_t ActivationSize(std::int64_t n) const;
  // Elements of scratch that Backward needs for n rows.
  std::int64_t ScratchSize(std::int64_t n) const;

  // activations [ActivationSize(n)] keeps every layer's output; returns the last one [n, outputs].
  template <typename T>
  const T* Forward(const T* params, std::int64_t n, const T* x, T* activations) const;
  // dy [n, outputs] is overwritten. dx [n, inputs - first] is the gradient of the inputs from
  // `first` on; it may be null. grads may be null (frozen).
  template <typename T>
  void Backward(const T* params, std::int64_t n, const T* x, const T* activations, T* dy, T* dx,
                Wide<T>* grads, T* scratch, std::int64_t first = 0) const;

  // PyTorch's default for linear layers: U(-1/sqrt(c), 1/sqrt(c)) for weights; biases zero.
  // The last layer's weights are multiplied by `last_scale`.
  void Initialize(Rng& rng, double last_scale, float* params) const;
  // U(-sqrt(6/c), sqrt(6/c)) for weights, zero biases: keeps the size of signals through layers of
  // ReLUs (He et al. 2015).
  void InitializeHe(Rng& rng, float* params) const;
  // Rescales and shifts every layer so that over the rows x [n, inputs] each of its outputs has
  // mean 0 and variance 1 before the activation (Salimans & Kingma 2016, section 3). Outputs that
  // do not vary are only shifted.
  void NormalizeOnData(std::int64_t n, const float* x, float* params) const;

  // Indices into the layout.
  int weight(int layer) const { return first_block_ + 2 * layer; }
  int bias(int layer) const { return first_block_ + 2 * layer + 1; }

 private:
  template <typename T>
  void ForwardBlock(const T* params, std::int64_t n, std::int64_t row, std::int64_t rows,
                    const T* x, T* activations) const;
  template <typename T>
  void BackwardBlock(const T* params, std::int64_t n, std::int64_t row, std::int64_t rows,
                     const T* x, const T* activations, T* dy, T* dx, Wide<T>* grads, T* scratch,
                     std::int64_t first) const;
  // What follows a layer.
  Activation After(int layer) const {
    return layer + 1 < layers() || activate_end_ ? activation_ : Activation::kNone;
  }
  // Weights U(-bound, bound), zero biases.
  void InitializeLayer(Rng& rng, int layer, double bound, float* params) const;

  std::vector<int> widths_;
  bool activate_end_;
  Activation activation_;
  int first_block_;
  std::vector<std::int64_t> weight_offset_, bias_offset_;
};

}  // namespace dexremoe
