#include "rl/rollout.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/random.h"
#include "rl/ppo_loss.h"

namespace dexremoe {
namespace {

constexpr int kActBlock = 256;  // rows of noise per unit of work

double Deviation(const RunningMoments& moments) { return std::sqrt(moments.variance[0] + 1e-5); }

}  // namespace

void DenormalizeValues(const RunningMoments& moments, float* values, std::int64_t n) {
  const double deviation = Deviation(moments);
  for (std::int64_t i = 0; i < n; ++i)
    values[i] = static_cast<float>(values[i] * deviation + moments.mean[0]);
}

void NormalizeValues(const RunningMoments& moments, float* values, std::int64_t n) {
  const double deviation = Deviation(moments);
  for (std::int64_t i = 0; i < n; ++i)
    values[i] = static_cast<float>((values[i] - moments.mean[0]) / deviation);
}

Rollout::Rollout(const PpoOptions& options, const Policy<float>& policy, VecEnv& env,
                 ThreadPool& pool)
    : options_(options), policy_(policy), env_(env), pool_(pool), inference_(policy, pool) {
  DEX_CHECK_EQ(env.obs_size(), policy.structure().obs_size);
  DEX_CHECK_EQ(env.phys_size(), policy.structure().phys_size);
  DEX_CHECK_EQ(env.num_actions(), policy.structure().num_actions);
  Resize();
}

void Rollout::Resize() {
  batch_.steps = options_.horizon;
  batch_.envs = env_.num_envs();
  const std::size_t rows = static_cast<std::size_t>(batch_.steps) * batch_.envs;
  batch_.obs.resize(rows * env_.obs_size());
  batch_.phys.resize(rows * env_.phys_size());
  batch_.object.resize(rows);
  batch_.frozen.resize(rows * policy_.frozen_size());
  batch_.noise.resize(rows * policy_.noise_size());
  batch_.mean.resize(rows * env_.num_actions());
  batch_.action.resize(rows * env_.num_actions());
  batch_.log_prob.resize(rows);
  batch_.value.resize(rows);
  batch_.reward.resize(rows);
  batch_.done.resize(rows);
  batch_.last_value.resize(batch_.envs);
  actions_.resize(static_cast<std::size_t>(batch_.envs) * env_.num_actions());
}

const RolloutBatch& Rollout::Collect(const TrainState& state, const ShapeInputs<float>& shapes,
                                     RunningMoments* obs_moments, RunningMoments* phys_moments) {
  const ParamBlock& spread = policy_.layout().block(policy_.log_std_block());
  batch_.log_std.assign(state.params.begin() + spread.offset,
                        state.params.begin() + spread.offset + spread.size());
  for (int t = 0; t < batch_.steps; ++t) {
    if (obs_moments != nullptr) UpdateMoments(batch_.envs, env_.obs().data(), *obs_moments);
    if (phys_moments != nullptr) UpdateMoments(batch_.envs, env_.phys().data(), *phys_moments);
    Observe(state, t);
    DrawRouterNoise(state, t);
    Act(state, shapes, t);
    Record(state, shapes, t, env_.Step(actions_));
  }
  LastValues(state, shapes);
  batch_.records = env_.TakeRecords();
  return batch_;
}

void Rollout::Observe(const TrainState& state, int t) {
  const std::size_t row = static_cast<std::size_t>(t) * batch_.envs;
  const Normalizers& norm = state.normalizers;
  Normalize(norm.obs, norm.clip, batch_.envs, env_.obs().data(),
            batch_.obs.data() + row * env_.obs_size());
  Normalize(norm.phys, norm.clip, batch_.envs, env_.phys().data(),
            batch_.phys.data() + row * env_.phys_size());
  std::copy(env_.object().begin(), env_.object().end(), batch_.object.begin() + row);
}

void Rollout::DrawRouterNoise(const TrainState& state, int t) {
  const int size = policy_.noise_size();
  if (size == 0) return;
  const std::size_t row = static_cast<std::size_t>(t) * batch_.envs;
  pool_.ParallelFor((batch_.envs + kActBlock - 1) / kActBlock, [&](int block, int) {
    const int end = std::min(batch_.envs, (block + 1) * kActBlock);
    for (int env = block * kActBlock; env < end; ++env) {
      Rng rng(state.seed, Stream::kRouter,
              {static_cast<std::uint64_t>(state.iteration), static_cast<std::uint64_t>(t),
               static_cast<std::uint64_t>(env_.first_env() + env)});
      policy_.DrawNoise(rng, batch_.noise.data() + (row + env) * size);
    }
  });
}

void Rollout::Act(const TrainState& state, const ShapeInputs<float>& shapes, int t) {
  const int envs = batch_.envs, count = env_.num_actions();
  const std::size_t row = static_cast<std::size_t>(t) * envs;
  float* mean = batch_.mean.data() + row * count;
  inference_.Run(
      state.params, shapes,
      {envs, batch_.obs.data() + row * env_.obs_size(), batch_.phys.data() + row * env_.phys_size(),
       batch_.object.data() + row, nullptr,
       policy_.noise_size() > 0 ? batch_.noise.data() + row * policy_.noise_size() : nullptr},
      {mean, batch_.value.data() + row, batch_.frozen.data() + row * policy_.frozen_size()});
  DenormalizeValues(state.normalizers.value, batch_.value.data() + row, envs);
  const ActionSpread<float> spread(count, batch_.log_std.data());
  std::vector<double> deviation(count);
  for (int a = 0; a < count; ++a) deviation[a] = std::exp(batch_.log_std[a]);
  const auto noise = [&](int block, int) {
    const int end = std::min(envs, (block + 1) * kActBlock);
    for (int env = block * kActBlock; env < end; ++env) {
      Rng rng(state.seed, Stream::kAction,
              {static_cast<std::uint64_t>(state.iteration), static_cast<std::uint64_t>(t),
               static_cast<std::uint64_t>(env_.first_env() + env)});
      float* action = batch_.action.data() + (row + env) * count;
      for (int a = 0; a < count; ++a)
        action[a] = static_cast<float>(mean[env * count + a] + deviation[a] * rng.Normal());
      std::copy_n(action, count, actions_.data() + static_cast<std::size_t>(env) * count);
      batch_.log_prob[row + env] = LogProbability(spread, action, mean + env * count);
    }
  };
  pool_.ParallelFor((envs + kActBlock - 1) / kActBlock, noise);
}

void Rollout::Record(const TrainState& state, const ShapeInputs<float>& shapes, int t,
                     const StepResult& result) {
  const std::size_t row = static_cast<std::size_t>(t) * batch_.envs;
  std::copy(result.reward.begin(), result.reward.end(), batch_.reward.begin() + row);
  for (int env = 0; env < batch_.envs; ++env)
    batch_.done[row + env] = result.end[env] != EpisodeEnd::kNone;
  Bootstrap(state, shapes, t, result);
}

// A timeout is no property of the state: what would have followed is estimated by the value of the
// last state (Pardo et al. 2018).
void Rollout::Bootstrap(const TrainState& state, const ShapeInputs<float>& shapes, int t,
                        const StepResult& result) {
  const std::size_t row = static_cast<std::size_t>(t) * batch_.envs;
  const int obs_size = env_.obs_size(), phys_size = env_.phys_size();
  last_obs_.clear();
  last_phys_.clear();
  last_object_.clear();
  std::vector<int> envs;
  for (std::size_t i = 0; i < result.ended.size(); ++i) {
    const int env = result.ended[i];
    if (result.end[env] != EpisodeEnd::kTimeout) continue;
    envs.push_back(env);
    last_object_.push_back(batch_.object[row + env]);
    const auto obs = result.last_obs.begin() + i * obs_size;
    const auto phys = result.last_phys.begin() + i * phys_size;
    last_obs_.insert(last_obs_.end(), obs, obs + obs_size);
    last_phys_.insert(last_phys_.end(), phys, phys + phys_size);
  }
  const std::int64_t n = static_cast<std::int64_t>(envs.size());
  if (n == 0) return;
  const Normalizers& norm = state.normalizers;
  Normalize(norm.obs, norm.clip, n, last_obs_.data(), last_obs_.data());
  Normalize(norm.phys, norm.clip, n, last_phys_.data(), last_phys_.data());
  std::vector<float> values(n);
  inference_.Run(state.params, shapes,
                 {n, last_obs_.data(), last_phys_.data(), last_object_.data(), nullptr},
                 {nullptr, values.data(), nullptr});
  DenormalizeValues(norm.value, values.data(), n);
  for (std::int64_t i = 0; i < n; ++i)
    batch_.reward[row + envs[i]] += static_cast<float>(options_.gamma) * values[i];
}

void Rollout::LastValues(const TrainState& state, const ShapeInputs<float>& shapes) {
  const Normalizers& norm = state.normalizers;
  last_obs_.resize(env_.obs().size());
  last_phys_.resize(env_.phys().size());
  Normalize(norm.obs, norm.clip, batch_.envs, env_.obs().data(), last_obs_.data());
  Normalize(norm.phys, norm.clip, batch_.envs, env_.phys().data(), last_phys_.data());
  inference_.Run(state.params, shapes,
                 {batch_.envs, last_obs_.data(), last_phys_.data(), env_.object().data(), nullptr},
                 {nullptr, batch_.last_value.data(), nullptr});
  DenormalizeValues(norm.value, batch_.last_value.data(), batch_.envs);
}

}  // namespace dexremoe
