// mu_pc and mu_e (paper, III-B): object descriptor and privileged state to the vector z.
#pragma once

#include <optional>

#include "nn/mlp.h"
#include "policy/policy.h"

namespace dexremoe {

// Activations of one pass, inside a Workspace.
template <typename T>
struct EncoderPass {
  T* feature;            // descriptors or points [K, feature_size]
  T* cloud;              // activations of mu_pc over the K objects, or over their points
  T* pooled;             // maximum over an object's points [K, f_size]
  std::int32_t* winner;  // row of the point that has it [K, f_size]
  T* shape;              // e_shape [K, shape_size]
  T* input;              // e = [e_phys as far as it is seen, e_shape] [n, phys_inputs + shape_size]
  T* extrinsics;         // activations of mu_e over the n rows
  // Backward only.
  T* dshape;    // of input, from e_shape on [n, shape_size]
  Wide<T>* df;  // [K, f_size], summed over rows
  T* df_stored;
  T* df_points;  // [K * cloud_points, f_size]
  T* cloud_scratch;
  T* extrinsics_scratch;
};

// Blocks "encoder/cloud/*" (when the cloud is seen) and "encoder/extrinsics/*".
class Encoder {
 public:
  Encoder(ParamLayout& layout, const PolicyStructure& structure);

  void Initialize(Rng& rng, float* params) const;

  template <typename T>
  EncoderPass<T> Carve(std::int64_t objects, std::int64_t n, Workspace<T>& work) const;
  // Fills pass.shape: f = mu_pc(p), or its maximum over the points, beside the one-hot category.
  template <typename T>
  void ShapeForward(const T* params, const ShapeInputs<Wide<T>>& shapes,
                    EncoderPass<T>& pass) const;
  // Needs ShapeForward; returns z [n, z_size].
  template <typename T>
  const T* Forward(const T* params, const PolicyRows<Wide<T>>& rows, EncoderPass<T>& pass) const;
  // dz [n, z_size] is overwritten. dshape [K, shape_size]: what e_shape's gradient is beside the
  // one through z (a gate that looks at it), or null.
  template <typename T>
  void Backward(const T* params, const ShapeInputs<Wide<T>>& shapes,
                const PolicyRows<Wide<T>>& rows, EncoderPass<T>& pass, T* dz, Wide<T>* grads,
                const Wide<T>* dshape = nullptr) const;

 private:
  // Rows that mu_pc is applied to.
  std::int64_t CloudRows(std::int64_t objects) const {
    return cloud_points_ > 0 ? objects * cloud_points_ : objects;
  }
  // Returns f [K, f_size].
  template <typename T>
  const T* CloudForward(const T* params, const ShapeInputs<Wide<T>>& shapes,
                        EncoderPass<T>& pass) const;
  template <typename T>
  void CloudBackward(const T* params, std::int64_t objects, const PolicyRows<Wide<T>>& rows,
                     EncoderPass<T>& pass, Wide<T>* grads, const Wide<T>* dshape) const;

  int phys_size_, phys_inputs_, feature_size_, cloud_points_, f_size_, num_categories_, shape_size_;
  std::vector<int> phys_seen_;
  bool see_category_;
  std::optional<Mlp> cloud_;
  Mlp extrinsics_;
};

}  // namespace dexremoe
