// Every choice of the PPO learner; section "ppo". Defaults: the paper (Table II) where it speaks,
// else what its line of work uses (IsaacGymEnvs, Hora; rl_games).
#pragma once

#include <cstdint>
#include <string>

#include "base/options.h"

namespace dexremoe {

struct PpoOptions {
  // Batch.
  int envs = 32768;       // paper
  int horizon = 8;        // steps per environment and iteration (paper)
  int minibatch = 16384;  // rows (paper)
  int mini_epochs = 5;    // NOTE(paper): silent; 5 in the line of work, 3 serve on CPUs
  int block_rows = 512;   // rows per unit of work; part of the result's rounding
  // Advantages.
  double gamma = 0.99;   // paper
  double lambda = 0.95;  // paper
  // Loss. NOTE(paper): silent but for the clip.
  double clip = 0.2;          // paper
  double critic_coef = 4;     // times 0.5
  bool clip_value = true;     // clipped value loss on normalised values
  double bounds_coef = 1e-4;  // two-sided, on |mean| beyond `bounds`
  double bounds = 1.1;
  double entropy_coef = 0;
  double max_grad_norm = 1;
  // Learning rate.
  double learning_rate = 5e-3;  // at the start (paper)
  bool adaptive = true;
  double kl_threshold = 0.02;  // paper
  // Threshold at the end of a training, come to geometrically from late_from on; 0: the same
  // throughout. NOTE(paper): not there.
  double kl_end = 0;
  double rate_factor = 1.5;
  double rate_min = 1e-6, rate_max = 1e-2;
  // "previous": against the policy that the rows met in the mini-epoch before (Hora, rl_games).
  // "rollout": against the one that acted.
  std::string kl_reference = "previous";
  // "auto", "f32" or "bf16": what the networks compute in; the parameters stay float32.
  // NOTE(paper): silent. bf16 where the processor multiplies it natively.
  std::string precision = "auto";
  // Inputs.
  double obs_clip = 5;  // of normalised inputs
  // Curriculum. NOTE(paper): not there ("from the initial epoch onward"); off by default.
  bool curriculum = false;
  double goal_angle_start = 1.0;  // rad
  double goal_angle_factor = 1.1;
  double velocity_start = 5.0;  // times the speeds a success allows
  double velocity_factor = 0.85;
  double gravity_start = 1;    // times gravity; below 0 objects fall into the palm at first
  double gravity_step = 0.05;  // rise of that factor with every advance
  // Until goals and speeds are the task's; then task.near_share, which it is throughout below 0.
  double near_share_start = -1;
  double fall_share_start = 1;        // of task.c_fall at first; rises linearly from late_from on
  double curriculum_threshold = 1.5;  // successes per episode
  double curriculum_period = 5e5;     // samples between decisions
  // Objects to begin with; once goals and speeds are the task's they double with every advance. 0:
  // all from the start.
  int curriculum_objects = 0;
  // Figures.
  int stats_window = 0;  // last episodes in the curve; 0 takes the number of environments

  // Late in a training. NOTE(paper): not there.
  double late_from = 0;  // share of its samples after which kl_end and fall_share_start act
  // Samples of the training, for these; 0: they are at their end, as befits a stage that goes on
  // from a trained policy. Set by the stage, no option.
  double span = 0;

  void Register(Options& options);
  double KlThreshold(std::int64_t samples) const;  // after so many samples
  double FallShare(std::int64_t samples) const;
  // Throws Error when the numbers do not fit together.
  void Check() const;

 private:
  double Late(std::int64_t samples) const;  // 0 until late_from, 1 at the end
};

}  // namespace dexremoe
