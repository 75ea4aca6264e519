#include "rl/ppo_options.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace dexremoe {

void PpoOptions::Register(Options& options) {
  options
      .Add("precision", &precision,
           "of the networks in training; auto: bf16 where the processor multiplies it")
      .Choices({"auto", "f32", "bf16"});
  options.Add("ppo.envs", &envs, "environments").Range(1, 1 << 20);
  options.Add("ppo.horizon", &horizon, "steps per environment and iteration").Range(1, 4096);
  options.Add("ppo.minibatch", &minibatch, "rows per optimiser step").Range(1, 1 << 24);
  options.Add("ppo.mini_epochs", &mini_epochs, "passes over a batch").Range(1, 100);
  options.Add("ppo.block_rows", &block_rows, "rows per unit of work").Range(16, 1 << 16);
  options.Add("ppo.gamma", &gamma, "discount per control step").Range(0, 1);
  options.Add("ppo.lambda", &lambda, "of generalised advantage estimation").Range(0, 1);
  options.Add("ppo.clip", &clip, "of the probability ratio and the value step").Range(0, 1);
  options.Add("ppo.critic_coef", &critic_coef, "weight of the value loss, times 0.5").Range(0, 1e3);
  options.Add("ppo.clip_value", &clip_value, "clip the value loss");
  options.Add("ppo.bounds_coef", &bounds_coef, "weight of the bounds loss").Range(0, 1e3);
  options.Add("ppo.bounds", &bounds, "|mean action| beyond which it acts").Range(0, 1e3);
  options.Add("ppo.entropy_coef", &entropy_coef, "weight of the entropy bonus").Range(0, 1e3);
  options.Add("ppo.max_grad_norm", &max_grad_norm, "gradient clipping").Range(1e-9, 1e9);
  options.Add("ppo.learning_rate", &learning_rate, "Adam's rate at the start").Range(0, 1);
  options.Add("ppo.adaptive", &adaptive, "adapt the rate to the KL divergence");
  options.Add("ppo.kl_threshold", &kl_threshold, "KL per mini-epoch, nats").Range(1e-9, 1e3);
  options.Add("ppo.kl_end", &kl_end, "its value at the end of a training; 0: the same throughout")
      .Range(0, 1e3);
  options.Add("ppo.rate_factor", &rate_factor, "step of the adaptive rate").Range(1, 100);
  options.Add("ppo.rate_min", &rate_min, "lower limit of the rate").Range(0, 1);
  options.Add("ppo.rate_max", &rate_max, "upper limit of the rate").Range(0, 1);
  options.Add("ppo.kl_reference", &kl_reference, "policy that the KL is taken against")
      .Choices({"previous", "rollout"});
  options.Add("ppo.obs_clip", &obs_clip, "limit of normalised inputs").Range(0.1, 1e6);
  options.Add("ppo.curriculum", &curriculum,
              "start with near goals, a loose speed rule and gravity_start");
  options.Add("ppo.goal_angle_start", &goal_angle_start, "first goal distance, rad").Range(0, 3.15);
  options.Add("ppo.goal_angle_factor", &goal_angle_factor, "widening").Range(1, 10);
  options.Add("ppo.velocity_start", &velocity_start, "first factor on the speeds").Range(1, 1e3);
  options.Add("ppo.velocity_factor", &velocity_factor, "tightening").Range(0.01, 1);
  options.Add("ppo.gravity_start", &gravity_start, "factor on gravity at first").Range(-10, 1);
  options.Add("ppo.gravity_step", &gravity_step, "rise of that factor at each advance")
      .Range(1e-6, 10);
  options
      .Add("ppo.near_share_start", &near_share_start,
           "share of near goals until goals and speeds are the task's; -1: task.near_share")
      .Range(-1, 1);
  options
      .Add("ppo.fall_share_start", &fall_share_start,
           "share of task.c_fall at the start of a training; all of it at the end")
      .Range(0, 100);
  options
      .Add("ppo.late_from", &late_from,
           "share of a training's samples before ppo.kl_end and ppo.fall_share_start act")
      .Range(0, 0.999);
  options.Add("ppo.curriculum_threshold", &curriculum_threshold, "successes per episode to advance")
      .Range(0, 600);
  options.Add("ppo.curriculum_period", &curriculum_period, "samples between decisions")
      .Range(1, 1e12);
  options
      .Add("ppo.curriculum_objects", &curriculum_objects,
           "objects at first, doubled once all else is the task's; 0: all")
      .Range(0, 1 << 20);
  options.Add("ppo.stats_window", &stats_window, "last episodes in the curve; 0: as environments")
      .Range(0, 1 << 24);
}

double PpoOptions::Late(std::int64_t samples) const {
  if (span == 0) return 1;
  return std::clamp((static_cast<double>(samples) / span - late_from) / (1 - late_from), 0.0, 1.0);
}

double PpoOptions::KlThreshold(std::int64_t samples) const {
  if (kl_end == 0) return kl_threshold;
  return kl_threshold * std::pow(kl_end / kl_threshold, Late(samples));
}

double PpoOptions::FallShare(std::int64_t samples) const {
  return fall_share_start + (1 - fall_share_start) * Late(samples);
}

void PpoOptions::Check() const {
  if (minibatch > static_cast<long long>(envs) * horizon)
    Fail("ppo.minibatch: expected at most ppo.envs x ppo.horizon = {}, found {}",
         static_cast<long long>(envs) * horizon, minibatch);
  if (rate_min > rate_max)
    Fail("ppo.rate_min: expected at most ppo.rate_max = {}, found {}", rate_max, rate_min);
}

}  // namespace dexremoe
