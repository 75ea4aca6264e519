// One hidden layer of MLoRE (Yang et al., CVPR 2024), on rows in order of their categories:
//   y = elu(W x + b + sum over the chosen i of p_i B_i A_i x + D_c C_c x)
// with a path W that all categories share, low-rank experts B_i A_i of different ranks, and a
// low-rank path of the row's category c. p = softmax(W_r e_shape + noise / E); the top_k largest
// act, with p as it is. Nothing between A and B: the whole layer is linear before its activation.
//
// NOTE(paper): MLoRE's layers are convolutions over an image, with batch normalisation behind them
// and no gradient from the shared path to x; neither carries over to a policy's trunk.
#pragma once

#include <string>
#include <vector>

#include "policy/category_rows.h"
#include "policy/policy.h"

namespace dexremoe {

// Inside a Workspace. n rows, c inputs, k outputs, R the sum of the ranks, Q the category's rank.
template <typename T>
struct MloreLayerPass {
  using W = Wide<T>;
  W *router_params, *probability, *weights, *dprobability;  // [E, d], [n, E]...
  T *low, *own, *out;                                       // [n, R] weighed, [n, Q], [n, k]
  W *low_wide, *part;                                       // [n, R] not weighed; [n, max(k, Q)]
  W *sum, *bias_gradient;                                   // [n, k]; a bias that no product has
  T* zero;                                                  // that bias
  T *dlow, *down, *dx;                                      // [n, R], [n, Q], [n, c]
};

class MloreLayer {
 public:
  static constexpr double kBalanceWeight = 3e-4;

  // Blocks "NAME/shared/weight|bias", "NAME/down" [R, c], "NAME/up" [k, R], "NAME/categoryC/down"
  // [Q, c], "NAME/categoryC/up" [k, Q], "NAME/router" [E, gate inputs].
  MloreLayer(ParamLayout& layout, const std::string& name, int inputs, int outputs,
             const PolicyStructure& structure);

  int inputs() const { return inputs_; }
  int outputs() const { return outputs_; }
  int experts() const { return static_cast<int>(ranks_.size()); }
  void Initialize(Rng& rng, float* params) const;

  template <typename T>
  MloreLayerPass<T> Carve(std::int64_t n, Workspace<T>& work) const;
  // gate_input [n, gate inputs], noise [n, experts] with this stride between rows, or null; both
  // and x [n, c] in order of `sorted`. Returns y [n, k].
  template <typename T>
  const T* Forward(const T* params, const CategoryRows& sorted, const T* x,
                   const Wide<T>* gate_input, const Wide<T>* noise, MloreLayerPass<T>& pass) const;
  // Balance loss (CV^2 of the summed p) over the rows; Backward will add `weight` times its
  // gradient.
  template <typename T>
  double Balance(std::int64_t n, Wide<T> weight, MloreLayerPass<T>& pass) const;
  // dy [n, k] is overwritten. Adds the gradients of x to dx [n, c] and of gate_input to
  // dgate_input.
  template <typename T>
  void Backward(const T* params, const CategoryRows& sorted, const T* x, const Wide<T>* gate_input,
                MloreLayerPass<T>& pass, T* dy, Wide<T>* dx, Wide<T>* dgate_input,
                Wide<T>* grads) const;

 private:
  template <typename T>
  void Route(const T* params, std::int64_t n, const Wide<T>* gate_input, const Wide<T>* noise,
             MloreLayerPass<T>& pass) const;
  template <typename T>
  void AddCategoryPaths(const T* params, const CategoryRows& sorted, const T* x,
                        MloreLayerPass<T>& pass) const;
  template <typename T>
  void CategoryBackward(const T* params, const CategoryRows& sorted, const T* x,
                        MloreLayerPass<T>& pass, const T* dy, Wide<T>* dx, Wide<T>* grads) const;
  // From the gradient of the weighed low-rank features to that of the plain ones, and of p.
  template <typename T>
  void WeighBackward(std::int64_t n, MloreLayerPass<T>& pass) const;
  void InitializeBlock(Rng& rng, std::int64_t offset, int rows, int columns, float* params) const;

  int inputs_, outputs_, gate_inputs_, top_k_, rank_, category_rank_, categories_;
  std::vector<int> ranks_;
  std::int64_t shared_, bias_, down_, up_, router_;  // offsets
  std::vector<std::int64_t> category_down_, category_up_;
};

}  // namespace dexremoe
