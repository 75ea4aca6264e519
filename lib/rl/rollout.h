// Experience: T steps of N environments under the present policy.
#pragma once

#include <cstdint>
#include <vector>

#include "base/thread_pool.h"
#include "policy/policy.h"
#include "rl/env.h"
#include "rl/inference.h"
#include "rl/ppo_options.h"
#include "rl/train_state.h"

namespace dexremoe {

// Time-major rows: row t * N + env; R = T N rows.
struct RolloutBatch {
  int steps = 0, envs = 0;
  std::vector<float> obs, phys;     // [R, ...], normalised
  std::vector<int> object;          // [R]
  std::vector<float> frozen;        // [R, frozen_size]
  std::vector<float> noise;         // [R, noise_size], of the router
  std::vector<float> mean, action;  // [R, A]; the action is not clamped
  std::vector<float> log_std;       // [A], of the policy that acted
  std::vector<float> log_prob;      // [R]
  std::vector<float> value;         // [R], in units of the return
  std::vector<float> reward;        // [R], with gamma V(last state) at timeouts
  std::vector<std::uint8_t> done;   // [R]
  std::vector<float> last_value;    // [N]
  std::vector<EpisodeRecord> records;
};

class Rollout {
 public:
  // All must outlive this.
  Rollout(const PpoOptions& options, const Policy<float>& policy, VecEnv& env, ThreadPool& pool);

  // Acts for options.horizon steps with exploration noise from (seed, kAction, iteration, t, env).
  // Inputs are normalised with state.normalizers as it stands; the raw ones are merged into
  // `obs_moments` and `phys_moments` (null when frozen), to be used from the next iteration on: so
  // the policy that learns is the one that acted.
  const RolloutBatch& Collect(const TrainState& state, const ShapeInputs<float>& shapes,
                              RunningMoments* obs_moments, RunningMoments* phys_moments);

 private:
  void Resize();
  void Observe(const TrainState& state, int t);
  void DrawRouterNoise(const TrainState& state, int t);
  void Act(const TrainState& state, const ShapeInputs<float>& shapes, int t);
  void Record(const TrainState& state, const ShapeInputs<float>& shapes, int t,
              const StepResult& result);
  void Bootstrap(const TrainState& state, const ShapeInputs<float>& shapes, int t,
                 const StepResult& result);
  void LastValues(const TrainState& state, const ShapeInputs<float>& shapes);

  PpoOptions options_;
  const Policy<float>& policy_;
  VecEnv& env_;
  ThreadPool& pool_;
  Inference inference_;
  RolloutBatch batch_;
  std::vector<float> actions_;               // [N, A]
  std::vector<float> last_obs_, last_phys_;  // rows whose value alone is wanted
  std::vector<int> last_object_;
};

// Rows of the network's value output to units of the return.
void DenormalizeValues(const RunningMoments& moments, float* values, std::int64_t n);
void NormalizeValues(const RunningMoments& moments, float* values, std::int64_t n);

}  // namespace dexremoe
