// Inside of ReorientBatch. Internal to lib/task.
#pragma once

#include <algorithm>
#include <utility>

#include "task/episode.h"
#include "task/episode_random.h"
#include "task/observation.h"
#include "task/reorient.h"
#include "task/rules.h"
#include "task/task_state.h"

namespace dexremoe {

struct ReorientBatch::Impl {
  Impl(const TaskOptions& task_options, const SimOptions& sim_options, const HandModel& hand_model,
       std::vector<TaskObject> task_objects, std::unique_ptr<BatchSim> simulator,
       std::uint64_t run_seed, ThreadPool& thread_pool);

  void Reset(int env, int object, std::uint64_t episode);

  // The parts of a decision: Begin, then for each of its control steps Command and Advance, then
  // Observe; all of these touch one environment and run on the pool. An environment whose episode
  // ends in between takes no part in the control steps that are left.
  void Begin(int env);
  void Command(int env, const float* action);
  void Advance(int env, const float* action);
  void Observe(int env);
  void EndEpisodes();

  // Randomisation (reorient_random.cpp).
  Rng NoiseOf(int env, int part, int time) const;
  void StartRandom(int env, EnvPhysics& start);
  void RestoreRandom(int env);
  std::vector<double> ActionOf(int env, const float* action);
  std::pair<double, double> TargetLimits(int env, int joint, double target) const;
  void PushAtRandom(int env);
  internal::Sight Look(int env) const;  // motions[env], as it is seen

  // Object and joints after the simulator's step, with velocities by finite difference.
  StepFacts Measure(int env, const float* action);
  void WriteRow(int env, const internal::Sight& sight);
  void JudgeGoal(int env, StepFacts& facts);
  // Objects are interleaved over the environments of all processes.
  int ObjectInUse(int env) const {
    const int all = static_cast<int>(objects.size());
    const int in_use = options.objects_in_use > 0 ? std::min(options.objects_in_use, all) : all;
    return (first_env + env) % in_use;
  }
  bool Jammed(int env) const {
    return options.goal_timeout > 0 && state.waited[env] >= options.goal_timeout;
  }
  EpisodeRecord RecordOf(int env) const;
  // Calls body(env) for all environments, in fixed chunks on the pool.
  void ForEachEnv(const std::function<void(int)>& body);

  internal::EpisodeKey KeyOf(int env) const {
    return {object_keys[state.object[env]], state.episode[env]};
  }
  const double* CommandShown(int env) const {
    const auto& rows = options.observe == "target" ? state.target : state.average;
    return &rows[static_cast<std::size_t>(env) * joints];
  }

  // Constant during a run.
  TaskOptions options;  // but for what curricula change
  double control_rate;  // Hz
  double gravity;       // m/s^2
  HandModel hand;
  std::vector<TaskObject> objects;
  std::vector<std::uint64_t> object_keys;
  std::uint64_t seed;
  int num_envs, joints, phys_size;
  int first_env = 0, total_envs;  // place in a batch over processes
  ThreadPool& pool;
  bool auto_reset = true;

  // Changed by steps.
  std::unique_ptr<BatchSim> sim;
  internal::TaskState state;
  std::vector<std::uint8_t> running;  // [N], within a decision
  std::vector<internal::ObjectMotion>
      motions;  // [N], over the last control step; at rest at the start
  std::vector<EnvPhysics> physics;
  std::vector<internal::EpisodeRandom> randoms;  // [N] with options.random.on
  std::vector<EpisodeRecord> records;
  StepResult result;
};

}  // namespace dexremoe
