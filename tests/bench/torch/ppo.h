// The PPO update of lib/rl/ppo.h on libtorch: the same advantages, loss, optimiser and adaptive
// rate, in the way one writes them there.
#pragma once

#include <memory>

#include "policy.h"

namespace torch_peer {

// As PpoOptions in lib/rl/ppo_options.h.
struct UpdateOptions {
  int minibatch = 16384, mini_epochs = 5;
  double gamma = 0.99, lambda = 0.95;
  double clip = 0.2, critic_coef = 4, bounds_coef = 1e-4, bounds = 1.1, max_grad_norm = 1;
  double learning_rate = 5e-3, kl_threshold = 0.02;
  double rate_factor = 1.5, rate_min = 1e-6, rate_max = 1e-2;
  bool bfloat16 = false;  // layers under autocast, which leaves parameters and the loss in float32
};

// Experience of T steps of N environments; R = T N rows, time-major.
struct Batch {
  Rows rows;                    // [R, ...]
  torch::Tensor action, mean;   // [R, actions]
  torch::Tensor log_prob;       // [R]
  torch::Tensor log_std;        // [actions]
  torch::Tensor reward, value;  // [T, N]
  torch::Tensor done;           // [T, N], 0 or 1
  torch::Tensor last_value;     // [N]
};

// log N(action; mean, exp(log_std)), summed over the actions: [n].
torch::Tensor LogProbability(const torch::Tensor& action, const torch::Tensor& mean,
                             const torch::Tensor& log_std);

class Learner {
 public:
  Learner(const UpdateOptions& options, Policy policy);

  // Returns the mean KL divergence of the last mini-epoch.
  double Update(const Batch& batch, const Shapes& shapes);

 private:
  void Prepare(const Batch& batch);
  PolicyImpl::Output Forward(const Shapes& shapes, const Rows& rows);
  // One optimiser step on the rows `pick` [n]; returns the sum of the rows' KL divergences.
  double Step(const Batch& batch, const Shapes& shapes, const torch::Tensor& pick);
  torch::Tensor Loss(const Batch& batch, const torch::Tensor& pick,
                     const PolicyImpl::Output& out) const;
  double Divergence(const torch::Tensor& pick, const torch::Tensor& mean);
  void AdaptRate(double kl);

  UpdateOptions options_;
  Policy policy_;
  double rate_;
  torch::optim::Adam adam_;
  // Of the batch at hand: [R], the last two [R, actions].
  torch::Tensor advantage_, target_, old_value_, reference_mean_, reference_log_std_;
};

}  // namespace torch_peer
