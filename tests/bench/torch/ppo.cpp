#include "ppo.h"

#include <ATen/autocast_mode.h>

#include <algorithm>
#include <cmath>

namespace torch_peer {

torch::Tensor LogProbability(const torch::Tensor& action, const torch::Tensor& mean,
                             const torch::Tensor& log_std) {
  const auto e = (action - mean) * torch::exp(-log_std);
  return (-0.5 * e * e - log_std - 0.5 * std::log(2 * M_PI)).sum(1);
}

Learner::Learner(const UpdateOptions& options, Policy policy)
    : options_(options),
      policy_(std::move(policy)),
      rate_(options.learning_rate),
      adam_(policy_->parameters(), torch::optim::AdamOptions(options.learning_rate)) {}

double Learner::Update(const Batch& batch, const Shapes& shapes) {
  Prepare(batch);
  const std::int64_t rows = advantage_.size(0);
  double kl = 0;
  for (int epoch = 0; epoch < options_.mini_epochs; ++epoch) {
    const auto order = torch::randperm(rows, torch::kInt64);
    kl = 0;
    for (std::int64_t begin = 0; begin < rows; begin += options_.minibatch)
      kl += Step(batch, shapes, order.slice(0, begin, std::min(rows, begin + options_.minibatch)));
    kl /= static_cast<double>(rows);
    AdaptRate(kl);
  }
  return kl;
}

// Generalised advantages, normalised over the batch; values and targets in units of the targets.
void Learner::Prepare(const Batch& batch) {
  const torch::NoGradGuard no_grad;
  auto advantage = torch::empty_like(batch.reward);
  auto next_value = batch.last_value, running = torch::zeros_like(batch.last_value);
  for (std::int64_t t = batch.reward.size(0) - 1; t >= 0; --t) {
    const auto alive = 1 - batch.done[t];
    const auto delta = batch.reward[t] + options_.gamma * next_value * alive - batch.value[t];
    running = delta + options_.gamma * options_.lambda * alive * running;
    advantage[t].copy_(running);
    next_value = batch.value[t];
  }
  const auto target = (advantage + batch.value).flatten();
  const auto shift = target.mean(), scale = torch::sqrt(target.var(false) + 1e-5);
  target_ = (target - shift) / scale;
  old_value_ = (batch.value.flatten() - shift) / scale;
  advantage_ = advantage.flatten();
  advantage_ = (advantage_ - advantage_.mean()) / (advantage_.std(false) + 1e-8);
  reference_mean_ = batch.mean.clone();
  reference_log_std_ = batch.log_std.expand_as(reference_mean_).clone();
}

double Learner::Step(const Batch& batch, const Shapes& shapes, const torch::Tensor& pick) {
  const Rows rows = {batch.rows.obs.index_select(0, pick), batch.rows.phys.index_select(0, pick),
                     batch.rows.object.index_select(0, pick)};
  const auto out = Forward(shapes, rows);
  adam_.zero_grad();
  Loss(batch, pick, out).backward();
  const double kl = Divergence(pick, out.mean.detach());
  torch::nn::utils::clip_grad_norm_(policy_->parameters(), options_.max_grad_norm);
  adam_.step();
  return kl;
}

// Autocast is on for the forward pass alone; the backward pass follows its types.
PolicyImpl::Output Learner::Forward(const Shapes& shapes, const Rows& rows) {
  at::autocast::set_autocast_cpu_dtype(at::kBFloat16);
  at::autocast::set_cpu_enabled(options_.bfloat16);
  const auto out = policy_->forward(shapes, rows);
  at::autocast::set_cpu_enabled(false);
  at::autocast::clear_cache();  // of weights as bfloat16: the next step has others
  return {out.mean.to(torch::kFloat32), out.value.to(torch::kFloat32)};
}

torch::Tensor Learner::Loss(const Batch& batch, const torch::Tensor& pick,
                            const PolicyImpl::Output& out) const {
  const auto log_prob =
      LogProbability(batch.action.index_select(0, pick), out.mean, policy_->log_std);
  const auto ratio = torch::exp(log_prob - batch.log_prob.index_select(0, pick));
  const auto advantage = advantage_.index_select(0, pick);
  const auto limited = torch::clamp(ratio, 1 - options_.clip, 1 + options_.clip);
  const auto surrogate = -torch::min(ratio * advantage, limited * advantage);

  const auto target = target_.index_select(0, pick), old = old_value_.index_select(0, pick);
  const auto moved = old + torch::clamp(out.value - old, -options_.clip, options_.clip);
  const auto fit = torch::max((out.value - target).square(), (moved - target).square());

  const auto over =
      torch::relu(out.mean - options_.bounds) + torch::relu(-out.mean - options_.bounds);
  return surrogate.mean() + 0.5 * options_.critic_coef * fit.mean() +
         options_.bounds_coef * over.square().sum(1).mean();
}

// KL of the policy from the one that the rows met before, which it then replaces.
double Learner::Divergence(const torch::Tensor& pick, const torch::Tensor& mean) {
  const torch::NoGradGuard no_grad;
  const auto log_std = policy_->log_std.detach();
  const auto old_mean = reference_mean_.index_select(0, pick);
  const auto old_log_std = reference_log_std_.index_select(0, pick);
  const auto spread = torch::exp(2 * (old_log_std - log_std));
  const auto shift = (mean - old_mean) * torch::exp(-log_std);
  const auto kl = (log_std - old_log_std + 0.5 * (spread + shift.square() - 1)).sum();
  reference_mean_.index_copy_(0, pick, mean);
  reference_log_std_.index_copy_(0, pick, log_std.expand_as(mean).contiguous());
  return kl.item<double>();
}

void Learner::AdaptRate(double kl) {
  if (kl > 2 * options_.kl_threshold)
    rate_ = std::max(rate_ / options_.rate_factor, options_.rate_min);
  else if (kl < 0.5 * options_.kl_threshold)
    rate_ = std::min(rate_ * options_.rate_factor, options_.rate_max);
  for (auto& group : adam_.param_groups())
    static_cast<torch::optim::AdamOptions&>(group.options()).lr(rate_);
}

}  // namespace torch_peer
