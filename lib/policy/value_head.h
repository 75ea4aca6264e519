// A linear layer from hidden features to action means and value, the value's row last.
#pragma once

#include <cmath>
#include <string>

#include "base/random.h"
#include "nn/layers.h"
#include "nn/params.h"

namespace dexremoe {

// Blocks "NAME/weight" [A + 1, hidden] and "NAME/bias" [A + 1].
class ValueHead {
 public:
  ValueHead(ParamLayout& layout, const std::string& name, int hidden, int actions)
      : hidden_(hidden),
        actions_(actions),
        weight_(layout.block(layout.Add(name + "/weight", actions + 1, hidden)).offset),
        bias_(layout.block(layout.Add(name + "/bias", actions + 1, 1)).offset) {}

  int outputs() const { return actions_ + 1; }
  // As Mlp::Initialize; the means' weights times `mean_scale`.
  void Initialize(Rng& rng, double mean_scale, float* params) const {
    const double bound = 1 / std::sqrt(hidden_);
    for (int i = 0; i < outputs() * hidden_; ++i)
      params[weight_ + i] = static_cast<float>((i < actions_ * hidden_ ? mean_scale : 1.0) *
                                               rng.Uniform(-bound, bound));
    for (int i = 0; i < outputs(); ++i) params[bias_ + i] = 0;
  }
  // hidden [n, hidden] -> out [n, A + 1].
  template <typename T>
  void Forward(const T* params, std::int64_t n, const T* hidden, Wide<T>* out) const {
    LinearForward<T>(n, hidden_, outputs(), hidden, params + weight_, params + bias_, out);
  }
  // Adds to grads; dhidden [n, hidden] is set.
  template <typename T>
  void Backward(const T* params, std::int64_t n, const T* hidden, const T* dout, T* dhidden,
                Wide<T>* grads) const {
    LinearBackward<T>(n, hidden_, outputs(), hidden, params + weight_, dout, dhidden,
                      grads + weight_, grads + bias_);
  }

 private:
  int hidden_, actions_;
  std::int64_t weight_, bias_;
};

}  // namespace dexremoe
