// Inside of ReorientBatch. Internal to lib/task.
#pragma once

#include "task/episode.h"
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

  // Object and joints after the simulator's step, with velocities by finite difference.
  StepFacts Measure(int env, const float* action);
  void WriteRow(int env, const internal::ObjectMotion& motion);
  void JudgeGoal(int env, StepFacts& facts);
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
  std::vector<std::uint8_t> running;            // [N], within a decision
  std::vector<internal::ObjectMotion> motions;  // [N], over the last control step
  std::vector<EnvPhysics> physics;
  std::vector<EpisodeRecord> records;
  StepResult result;
};

}  // namespace dexremoe
