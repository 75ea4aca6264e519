#include "policy/residual.h"

#include <algorithm>

#include "nn/kernels.h"

namespace dexremoe {
namespace {

// An actor whose z is [z, a_base].
PolicyStructure ResidualStructure(PolicyStructure s) {
  s.z_size += s.num_actions;
  return s;
}

}  // namespace

template <typename T>
ResidualPolicy<T>::ResidualPolicy(const PolicyStructure& s)
    : Policy<T>(s),
      encoder_(this->layout_, s),
      base_(this->layout_, "actor", s),
      residual_(this->layout_, "residual", ResidualStructure(s)) {
  this->log_std_block_ = this->layout_.Add("log_std", s.num_actions, 1);
  this->SetTrainable("", false);
  this->SetTrainable("residual/", true);
  this->SetTrainable("log_std", true);
}

template <typename T>
void ResidualPolicy<T>::Initialize(std::uint64_t seed, double log_std, double mean_scale,
                                   float* params) const {
  Rng rng(seed, Stream::kInit);
  encoder_.Initialize(rng, params);
  base_.Initialize(rng, mean_scale, params);
  residual_.Initialize(rng, 0, params);
  const ParamBlock& value = this->layout_.block(this->layout_.Find("residual/value/0/weight"));
  std::fill_n(params + value.offset, value.size(), 0.0f);
  this->FillLogStd(log_std, params);
}

template <typename T>
int ResidualPolicy<T>::frozen_size() const {
  return seen() + 1;
}

template <typename T>
void ResidualPolicy<T>::Freeze(const T* params, const ShapeInputs<W>& shapes,
                               const PolicyRows<W>& rows, Workspace<T>& work, W* frozen) const {
  const int z_size = this->structure_.z_size, actions = this->structure_.num_actions;
  work.Reset();
  EncoderPass<T> encoder = encoder_.Carve(shapes.objects, rows.n, work);
  ActorPass<T> actor = base_.Carve(rows.n, work);
  W* mean = work.template Take<W>(rows.n * actions);
  W* value = work.template Take<W>(rows.n);
  encoder_.ShapeForward(params, shapes, encoder);
  const T* z = encoder_.Forward(params, rows, encoder);
  base_.Forward(params, rows, z, actor, mean, value);
  for (std::int64_t r = 0; r < rows.n; ++r) {
    W* row = frozen + r * frozen_size();
    Cast(z_size, z + r * z_size, row);
    std::copy_n(mean + r * actions, actions, row + z_size);
    row[seen()] = value[r];
  }
}

template <typename T>
void ResidualPolicy<T>::Forward(const T* params, const ShapeInputs<W>& shapes,
                                const PolicyRows<W>& rows, Workspace<T>& work, W* mean,
                                W* value) const {
  const int actions = this->structure_.num_actions;
  std::vector<W> own;
  const W* frozen = rows.frozen;
  if (frozen == nullptr) {
    own.resize(rows.n * frozen_size());
    Freeze(params, shapes, rows, work, own.data());
    frozen = own.data();
  }
  work.Reset();
  ActorPass<T> actor = residual_.Carve(rows.n, work);
  W* seen_rows = work.template Take<W>(rows.n * seen());
  for (std::int64_t r = 0; r < rows.n; ++r)
    std::copy_n(frozen + r * frozen_size(), seen(), seen_rows + r * seen());
  residual_.Forward(params, rows, seen_rows, actor, mean, value);
  for (std::int64_t r = 0; r < rows.n; ++r) {
    const W* base = frozen + r * frozen_size() + this->structure_.z_size;
    for (int a = 0; a < actions; ++a) mean[r * actions + a] += base[a];
    value[r] += base[actions];
  }
}

template <typename T>
void ResidualPolicy<T>::Backward(const T* params, const ShapeInputs<W>& /*shapes*/,
                                 const PolicyRows<W>& rows, Workspace<T>& work, const W* dmean,
                                 const W* dvalue, W* grads) const {
  work.Reset();
  ActorPass<T> actor = residual_.Carve(rows.n, work);
  residual_.Backward(params, rows, actor, dmean, dvalue, false, grads);
}

template class ResidualPolicy<BFloat16>;
template class ResidualPolicy<float>;
template class ResidualPolicy<double>;

}  // namespace dexremoe
