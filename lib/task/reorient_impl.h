// Inside of ReorientBatch. Internal to lib/task.
#pragma once

#include "task/episode.h"
#include "task/reorient.h"
#include "task/rules.h"
#include "task/task_state.h"

namespace dexremoe {

struct ReorientBatch::Impl {
  Impl(const TaskOptions& task_options, const SimOptions& sim_options, const HandModel& hand_model,
       std::vector<TaskObject> task_objects, std::unique_ptr<BatchSim> simulator,
       std::uint64_t run_seed, ThreadPool& thread_pool);

  void Reset(int env, int object, std::uint64_t episode);

  // The three parts of a step. Command and Finish touch one environment and run on the pool.
  void Command(int env, const float* action);
  void Finish(int env, const float* action);
  void EndEpisodes();

  // Object and joints after the simulator's step, with velocities by finite difference.
  StepFacts Measure(int env, const float* action);
  void JudgeGoal(int env, StepFacts& facts);
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
  int num_envs, joints;
  int first_env = 0, total_envs;  // place in a batch over processes
  ThreadPool& pool;
  bool auto_reset = true;

  // Changed by steps.
  std::unique_ptr<BatchSim> sim;
  internal::TaskState state;
  std::vector<EnvPhysics> physics;
  std::vector<EpisodeRecord> records;
  StepResult result;
};

}  // namespace dexremoe
