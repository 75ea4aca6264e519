// A task with a known optimum behind the VecEnv interface: a point is to be brought to its goal.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/bytes.h"
#include "base/check.h"
#include "base/random.h"
#include "rl/env.h"

namespace dexremoe {

// x in the plane, x += 0.2 s clamp(a); reward 2 - |x - goal|; episodes of 20 steps, or until |x|
// > 2. (Were rewards negative, running out of bounds would pay.) The sign s belongs to the object,
// so that the policy must look at the object's descriptor: objects 0 and 2 push, 1 and 3 pull. obs
// = [x, previous action], phys = goal.
class ToyEnv final : public VecEnv {
 public:
  static constexpr int kObjects = 4, kLength = 20;

  // Environments first .. first + envs - 1 of a larger task.
  ToyEnv(int envs, std::uint64_t seed, int first = 0) : seed_(seed), first_(first), state_(envs) {
    obs_.resize(4 * envs);
    phys_.resize(2 * envs);
    object_.resize(envs);
    result_.reward.resize(envs);
    result_.success.resize(envs);
    result_.end.resize(envs);
    for (int env = 0; env < envs; ++env) object_[env] = (first + env) % kObjects;
  }

  static double Sign(int object) { return object % 2 == 0 ? 1 : -1; }

  int num_envs() const override { return static_cast<int>(state_.size()); }
  int first_env() const override { return first_; }
  int obs_size() const override { return 4; }
  int phys_size() const override { return 2; }
  int num_actions() const override { return 2; }
  const std::vector<float>& obs() const override { return obs_; }
  const std::vector<float>& phys() const override { return phys_; }
  const std::vector<int>& object() const override { return object_; }
  const TaskDifficulty& difficulty() const { return difficulty_; }

  void ResetAll() override {
    for (int env = 0; env < num_envs(); ++env) {
      state_[env] = {};
      Reset(env);
      Observe(env);
    }
  }

  const StepResult& Step(const std::vector<float>& actions) override {
    DEX_CHECK_EQ(actions.size(), 2 * state_.size());
    result_.ended.clear();
    result_.last_obs.clear();
    result_.last_phys.clear();
    for (int env = 0; env < num_envs(); ++env) StepOne(env, &actions[2 * env]);
    return result_;
  }

  std::vector<EpisodeRecord> TakeRecords() override { return std::exchange(records_, {}); }
  void SetDifficulty(const TaskDifficulty& difficulty) override { difficulty_ = difficulty; }
  std::vector<std::uint8_t> Save() const override {
    ByteWriter bytes;
    bytes.PutVector(state_);
    return bytes.Take();
  }
  void Restore(const std::vector<std::uint8_t>& saved) override {
    ByteReader bytes(saved);
    state_ = bytes.GetVector<State>();
    bytes.Finish();
    for (int env = 0; env < num_envs(); ++env) Observe(env);
  }

 private:
  struct State {
    double x[2] = {0, 0}, goal[2] = {0, 0}, action[2] = {0, 0};
    std::uint64_t episode = 0;
    int length = 0;
    double reward = 0, distance = 0;
  };

  void Reset(int env) {
    State& s = state_[env];
    const std::uint64_t episode = s.episode;
    s = {};
    s.episode = episode + 1;
    Rng rng(seed_, Stream::kReset, {static_cast<std::uint64_t>(first_ + env), episode});
    for (int i = 0; i < 2; ++i) {
      s.x[i] = rng.Uniform(-1, 1);
      s.goal[i] = rng.Uniform(-1, 1);
    }
  }

  void Observe(int env) {
    const State& s = state_[env];
    for (int i = 0; i < 2; ++i) {
      obs_[4 * env + i] = static_cast<float>(s.x[i]);
      obs_[4 * env + 2 + i] = static_cast<float>(s.action[i]);
      phys_[2 * env + i] = static_cast<float>(s.goal[i]);
    }
  }

  void StepOne(int env, const float* action) {
    State& s = state_[env];
    for (int i = 0; i < 2; ++i) {
      s.action[i] = std::clamp<double>(action[i], -1, 1);
      s.x[i] += 0.2 * Sign(object_[env]) * s.action[i];
    }
    const double distance = std::hypot(s.x[0] - s.goal[0], s.x[1] - s.goal[1]);
    result_.reward[env] = static_cast<float>(2 - distance);
    result_.success[env] = distance < 0.1;
    s.reward += 2 - distance;
    s.distance += distance;
    ++s.length;
    const bool fall = std::hypot(s.x[0], s.x[1]) > 2;
    result_.end[env] = fall                  ? EpisodeEnd::kFall
                       : s.length == kLength ? EpisodeEnd::kTimeout
                                             : EpisodeEnd::kNone;
    Observe(env);
    if (result_.end[env] == EpisodeEnd::kNone) return;
    result_.ended.push_back(env);
    result_.last_obs.insert(result_.last_obs.end(), &obs_[4 * env], &obs_[4 * env] + 4);
    result_.last_phys.insert(result_.last_phys.end(), &phys_[2 * env], &phys_[2 * env] + 2);
    EpisodeRecord record;
    record.env = env;
    record.object = object_[env];
    record.episode = s.episode;
    record.length = s.length;
    record.successes = result_.success[env];
    record.end = result_.end[env];
    record.total_reward = s.reward;
    record.mean_distance = s.distance / s.length;
    records_.push_back(record);
    Reset(env);
    Observe(env);
  }

  std::uint64_t seed_;
  int first_;
  std::vector<State> state_;
  std::vector<float> obs_, phys_;
  std::vector<int> object_;
  StepResult result_;
  std::vector<EpisodeRecord> records_;
  TaskDifficulty difficulty_;
};

}  // namespace dexremoe
