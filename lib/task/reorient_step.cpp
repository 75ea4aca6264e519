// One control step of the task, and the start of an episode.
#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "task/observation.h"
#include "task/reorient_impl.h"
#include "task/rotation.h"

namespace dexremoe {
namespace {

constexpr int kChunk = 64;  // environments

using Eigen::Quaterniond;
using Eigen::Vector3d;

Vector3d VectorAt(const std::vector<double>& rows, int env) {
  return Vector3d(&rows[static_cast<std::size_t>(env) * 3]);
}

Quaterniond QuaternionAt(const std::vector<double>& rows, int env) {
  const double* q = &rows[static_cast<std::size_t>(env) * 4];
  return {q[0], q[1], q[2], q[3]};
}

void PutPose(const Pose& X_WO, int env, std::vector<double>& position,
             std::vector<double>& rotation) {
  std::copy_n(X_WO.p.data(), 3, &position[static_cast<std::size_t>(env) * 3]);
  const double q[] = {X_WO.q.w(), X_WO.q.x(), X_WO.q.y(), X_WO.q.z()};
  std::copy_n(q, 4, &rotation[static_cast<std::size_t>(env) * 4]);
}

Quaterniond GoalAt(const internal::TaskState& state, int env) {
  const auto& g = state.goal[env];
  return {g[0], g[1], g[2], g[3]};
}

double Clamp1(float action) { return std::clamp(static_cast<double>(action), -1.0, 1.0); }

}  // namespace

void ReorientBatch::Impl::ForEachEnv(const std::function<void(int)>& body) {
  const int chunks = (num_envs + kChunk - 1) / kChunk;
  pool.ParallelFor(chunks, [&](int chunk, int) {
    const int end = std::min(num_envs, (chunk + 1) * kChunk);
    for (int env = chunk * kChunk; env < end; ++env) body(env);
  });
}

void ReorientBatch::Impl::Reset(int env, int object, std::uint64_t episode) {
  DEX_CHECK(env >= 0 && env < num_envs);
  DEX_CHECK(object >= 0 && object < static_cast<int>(objects.size()));
  internal::TaskState& s = state;
  s.object[env] = object;
  s.episode[env] = episode;
  s.gravity[env] = options.gravity_factor * gravity;
  internal::EpisodeStart start =
      internal::DrawStart(options, objects[object], s.gravity[env], seed, KeyOf(env));
  if (options.random.on) StartRandom(env, start.physics);
  const Grasp& grasp = objects[object].grasps[start.grasp];
  physics[env] = start.physics;
  s.grasp[env] = start.grasp;
  s.length[env] = s.successes[env] = s.goals[env] = s.held[env] = s.waited[env] = 0;
  s.total_reward[env] = s.total_angle[env] = s.total_distance[env] = 0;
  s.live[env] = 1;

  sim->SetObject(env, object, start.physics);
  EnvState sim_state{grasp.q, std::vector<double>(joints, 0.0), grasp.X_WO};
  sim->SetState(env, sim_state);
  sim->SetHeld(env, false);

  const std::size_t row = static_cast<std::size_t>(env) * joints;
  std::copy(grasp.q.begin(), grasp.q.end(), &s.q[row]);
  std::copy(grasp.target.begin(), grasp.target.end(), &s.target[row]);
  std::fill_n(&s.average[row], joints, 0.0);
  std::fill_n(&s.qd[row], joints, 0.0);
  PutPose(grasp.X_WO, env, s.position, s.rotation);
  const Quaterniond goal =
      internal::DrawEpisodeGoal(options, grasp.X_WO.q, seed, KeyOf(env), s.goals[env]++);
  s.goal[env] = {goal.w(), goal.x(), goal.y(), goal.z()};
  s.angle[env] = RotationDistance(grasp.X_WO.q, goal);
  s.distance[env] = (grasp.X_WO.p - Vector3d(options.grasp_center.data())).norm();
  motions[env] = {grasp.X_WO};
  const internal::Sight sight = Look(env);
  internal::StartHistory(options, hand, sight.q, CommandShown(env), &s.obs[6 * row]);
  WriteRow(env, sight);
}

// e_phys of the present state as it is seen.
void ReorientBatch::Impl::WriteRow(int env, const internal::Sight& sight) {
  const internal::ObjectMotion& motion = sight.motion;
  const std::size_t row = static_cast<std::size_t>(env) * joints;
  const std::uint8_t* touch = &sim->state().tip_contact[env * hand.chains.size()];
  const Quaterniond q_WG = internal::ShownGoal(options, motion.X_WO.q, GoalAt(state, env));
  float* const extras = internal::WritePhys(physics[env], motion, q_WG,
                                            &state.phys[static_cast<std::size_t>(env) * phys_size]);
  internal::WriteExtras(options, hand, {sight.q, &state.qd[row], touch, state.waited[env]},
                        motion.X_WO, q_WG, extras);
}

// NOTE(paper): says only that a moving average of actions gives joint targets. Here an action moves
// the previous target, kept near the joint: absolute targets drop the object within 20 steps.
void ReorientBatch::Impl::Command(int env, const float* action) {
  if (!running[env]) return;
  const std::size_t row = static_cast<std::size_t>(env) * joints;
  std::vector<double> disturbed;
  if (options.random.on) {
    disturbed = ActionOf(env, action);
    PushAtRandom(env);
  }
  for (int j = 0; j < joints; ++j) {
    double& average = state.average[row + j];
    const double wanted = disturbed.empty() ? Clamp1(action[j]) : disturbed[j];
    average += options.ema * (wanted - average);
    double& target = state.target[row + j];
    const double q = state.q[row + j];
    const auto [lower, upper] = TargetLimits(env, j, target);
    target = std::clamp(target + options.action_scale * average, q - options.target_leash,
                        q + options.target_leash);
    target = std::clamp(target, lower, upper);
  }
}

StepFacts ReorientBatch::Impl::Measure(int env, const float* action) {
  internal::TaskState& s = state;
  const SimState& now = sim->state();
  const std::size_t row = static_cast<std::size_t>(env) * joints;
  StepFacts facts;
  for (int j = 0; j < joints; ++j) {
    const double q = now.joint_position[row + j];
    s.qd[row + j] = (q - s.q[row + j]) * control_rate;
    const double speed = std::abs(s.qd[row + j]);
    facts.max_joint_speed = std::max(facts.max_joint_speed, speed);
    facts.excess_joint_speed += std::max(0.0, speed - options.joint_speed_clip);
    facts.squared_action += Clamp1(action[j]) * Clamp1(action[j]);
    s.q[row + j] = q;
  }
  internal::ObjectMotion& motion = motions[env];
  motion.X_WO = {QuaternionAt(now.object_rotation, env), VectorAt(now.object_position, env)};
  motion.v = (motion.X_WO.p - VectorAt(s.position, env)) * control_rate;
  motion.w =
      RotationVector(motion.X_WO.q * QuaternionAt(s.rotation, env).conjugate()) * control_rate;
  PutPose(motion.X_WO, env, s.position, s.rotation);
  // NOTE(paper): the goal position is not given; it is the grasp centre, where episodes start.
  s.distance[env] = (motion.X_WO.p - Vector3d(options.grasp_center.data())).norm();
  facts.previous_angle = s.angle[env];
  s.angle[env] = RotationDistance(motion.X_WO.q, GoalAt(s, env));
  facts.angle = s.angle[env];
  facts.distance = s.distance[env];
  facts.speed = motion.v.norm();
  facts.spin = motion.w.norm();
  facts.fall = facts.distance > options.fall_distance;
  JudgeGoal(env, facts);
  return facts;
}

// After a success the next goal is drawn; object and clock go on.
// NOTE(paper): how long the conditions must hold is not given; hold_steps = 1 by default.
void ReorientBatch::Impl::JudgeGoal(int env, StepFacts& facts) {
  internal::TaskState& s = state;
  s.held[env] = MeetsGoal(options, facts) ? s.held[env] + 1 : 0;
  facts.success = s.held[env] >= options.hold_steps;
  ++s.waited[env];
  if (!facts.success) return;
  s.held[env] = s.waited[env] = 0;
  ++s.successes[env];
  const Quaterniond q_WO = QuaternionAt(s.rotation, env);
  const Quaterniond goal =
      internal::DrawEpisodeGoal(options, q_WO, seed, KeyOf(env), s.goals[env]++);
  s.goal[env] = {goal.w(), goal.x(), goal.y(), goal.z()};
  s.angle[env] = RotationDistance(q_WO, goal);
}

void ReorientBatch::Impl::Begin(int env) {
  running[env] = state.live[env];
  result.reward[env] = 0;
  result.success[env] = 0;
  result.end[env] = EpisodeEnd::kNone;
}

void ReorientBatch::Impl::Advance(int env, const float* action) {
  internal::TaskState& s = state;
  if (!running[env]) return;
  StepFacts facts = Measure(env, action);
  facts.jam = !facts.fall && Jammed(env);
  const double reward = Reward(options, facts);
  ++s.length[env];
  s.total_reward[env] += reward;
  s.total_angle[env] += facts.angle;
  s.total_distance[env] += facts.distance;
  result.reward[env] += static_cast<float>(reward);
  result.success[env] |= facts.success;
  if (facts.fall)
    result.end[env] = EpisodeEnd::kFall;
  else if (facts.jam)
    result.end[env] = EpisodeEnd::kJam;
  else if (s.length[env] >= options.episode_length)
    result.end[env] = EpisodeEnd::kTimeout;
  running[env] = result.end[env] == EpisodeEnd::kNone;
}

void ReorientBatch::Impl::Observe(int env) {
  if (!state.live[env]) return;
  const std::size_t row = static_cast<std::size_t>(env) * joints;
  const internal::Sight sight = Look(env);
  internal::PushHistory(options, hand, sight.q, CommandShown(env), &state.obs[6 * row]);
  WriteRow(env, sight);
}

EpisodeRecord ReorientBatch::Impl::RecordOf(int env) const {
  EpisodeRecord record;
  record.env = env;
  record.object = state.object[env];
  record.episode = state.episode[env];
  record.length = state.length[env];
  record.successes = state.successes[env];
  record.end = result.end[env];
  record.total_reward = state.total_reward[env];
  record.mean_angle = state.total_angle[env] / state.length[env];
  record.mean_distance = state.total_distance[env] / state.length[env];
  record.bound = internal::DrawBound(options.random, seed, KeyOf(env));
  return record;
}

void ReorientBatch::Impl::EndEpisodes() {
  result.ended.clear();
  result.last_obs.clear();
  result.last_phys.clear();
  const std::size_t width = 6 * static_cast<std::size_t>(joints);
  for (int env = 0; env < num_envs; ++env) {
    if (result.end[env] == EpisodeEnd::kNone) continue;
    records.push_back(RecordOf(env));
    const auto obs = state.obs.begin() + env * width;
    const auto phys = state.phys.begin() + static_cast<std::size_t>(env) * phys_size;
    result.ended.push_back(env);
    result.last_obs.insert(result.last_obs.end(), obs, obs + width);
    result.last_phys.insert(result.last_phys.end(), phys, phys + phys_size);
    if (auto_reset)
      Reset(env, options.objects_in_use > 0 ? ObjectInUse(env) : state.object[env],
            state.episode[env] + total_envs);
    else
      state.live[env] = 0;
  }
}

}  // namespace dexremoe
