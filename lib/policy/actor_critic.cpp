#include "policy/actor_critic.h"

#include <algorithm>

#include "nn/kernels.h"

namespace dexremoe {

template <typename T>
ActorCritic<T>::ActorCritic(const PolicyStructure& structure)
    : Policy<T>(structure),
      encoder_(this->layout_, structure),
      actor_(this->layout_, "actor", structure) {
  this->log_std_block_ = this->layout_.Add("log_std", structure.num_actions, 1);
  this->SetTrainable("", true);
  this->SetTrainable("encoder/", structure.train_encoders);
}

template <typename T>
void ActorCritic<T>::Initialize(std::uint64_t seed, double log_std, double mean_scale,
                                float* params) const {
  Rng rng(seed, Stream::kInit);
  encoder_.Initialize(rng, params);
  actor_.Initialize(rng, mean_scale, params);
  this->FillLogStd(log_std, params);
}

template <typename T>
int ActorCritic<T>::frozen_size() const {
  return this->structure_.train_encoders ? 0 : this->structure_.z_size;
}

template <typename T>
void ActorCritic<T>::Freeze(const T* params, const ShapeInputs<Wide<T>>& shapes,
                            const PolicyRows<Wide<T>>& rows, Workspace<T>& work,
                            Wide<T>* frozen) const {
  if (frozen_size() == 0) return;
  work.Reset();
  EncoderPass<T> pass = encoder_.Carve(shapes.objects, rows.n, work);
  encoder_.ShapeForward(params, shapes, pass);
  Cast(rows.n * frozen_size(), encoder_.Forward(params, rows, pass), frozen);
}

template <typename T>
void ActorCritic<T>::Forward(const T* params, const ShapeInputs<Wide<T>>& shapes,
                             const PolicyRows<Wide<T>>& rows, Workspace<T>& work, Wide<T>* mean,
                             Wide<T>* value) const {
  work.Reset();
  ActorPass<T> actor = actor_.Carve(rows.n, work);
  if (rows.frozen != nullptr) {
    actor_.Forward(params, rows, rows.frozen, actor, mean, value);
    return;
  }
  EncoderPass<T> encoder = encoder_.Carve(shapes.objects, rows.n, work);
  encoder_.ShapeForward(params, shapes, encoder);
  actor_.Forward(params, rows, encoder_.Forward(params, rows, encoder), actor, mean, value);
}

template <typename T>
void ActorCritic<T>::Backward(const T* params, const ShapeInputs<Wide<T>>& shapes,
                              const PolicyRows<Wide<T>>& rows, Workspace<T>& work,
                              const Wide<T>* dmean, const Wide<T>* dvalue, Wide<T>* grads) const {
  work.Reset();
  ActorPass<T> actor = actor_.Carve(rows.n, work);
  const bool train_encoders = this->structure_.train_encoders;
  T* dz = actor_.Backward(params, rows, actor, dmean, dvalue, train_encoders, grads);
  if (!train_encoders) return;
  EncoderPass<T> encoder = encoder_.Carve(shapes.objects, rows.n, work);
  encoder_.Backward(params, shapes, rows, encoder, dz, grads);
}

template class ActorCritic<BFloat16>;
template class ActorCritic<float>;
template class ActorCritic<double>;

}  // namespace dexremoe
