#include "eval/sim_bench.h"

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/check.h"

namespace dexremoe {
namespace {

// Bytes handed out by malloc, of all threads.
double HeapBytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

}  // namespace

void SimBenchOptions::Register(Options& options) {
  options.Add("substeps", &substeps, "of every engine in the comparison").Range(1, 64);
  options.Add("rounds", &rounds, "time slices of each engine in the comparison").Range(1, 1000);
  options.Add("slice", &slice, "seconds of a time slice").Range(0, 60);
  options.Add("warm_up", &warm_up, "seconds before the first slice").Range(0, 60);
  options.Add("envs", &envs, "environments of lanes where they are not what is studied")
      .Range(1, 1e6);
  options.Add("slow_envs", &slow_envs, "the same, of the other engines").Range(1, 1e6);
  options.Add("max_envs", &max_envs, "largest number of environments, lanes").Range(1, 1e6);
  options.Add("max_slow_envs", &max_slow_envs, "the same, of the other engines").Range(1, 1e6);
  options.Add("max_objects", &max_objects, "largest number of different objects").Range(1, 10000);
  options.Add("noise", &noise, "spread of the random actions").Range(0, 100);
  options.Add("seed", &seed, "of all random numbers");
}

void SimBenchOptions::MakeQuick() {
  rounds = 2;
  slice = warm_up = 0.02;
  envs = slow_envs = 64;
  max_envs = 512;
  max_slow_envs = 128;
  max_objects = 3;
}

TimedRollout::TimedRollout(const SimBenchOptions& options, const EngineSetting& setting,
                           const HandModel& hand, const TaskOptions& task,
                           const std::vector<GraspedObject>& objects, int num_envs, int workers)
    : options_(options),
      label_(setting.label),
      pool_(workers),
      rollout_(setting.sim, hand, task, objects, num_envs, options.noise, options.seed, pool_) {}

void TimedRollout::WarmUp() {
  double wall = 0;
  for (int step = 0; step < 20 && wall <= options_.warm_up; ++step) wall += rollout_.Step().wall;
  first_falls_ = rollout_.falls();
}

void TimedRollout::RunSlice() {
  RandomRollout::Cost total;
  double env_steps = 0;
  do {
    const RandomRollout::Cost cost = rollout_.Step();
    total.wall += cost.wall;
    total.cpu += cost.cpu;
    env_steps += rollout_.sim().num_envs();
    const std::vector<int>& contacts = rollout_.sim().state().contact_count;
    contacts_ += std::accumulate(contacts.begin(), contacts.end(), 0.0);
  } while (total.wall < options_.slice);
  env_steps_ += env_steps;
  wall_rates_.push_back(env_steps / total.wall);
  cpu_rates_.push_back(env_steps / total.cpu);
}

double TimedRollout::contacts() const { return contacts_ / env_steps_; }

double TimedRollout::episode_steps() const {
  const auto falls = rollout_.falls() - first_falls_;
  if (falls == 0) return std::numeric_limits<double>::quiet_NaN();
  return env_steps_ / static_cast<double>(falls);
}

void RunInterleaved(const std::vector<std::unique_ptr<TimedRollout>>& rollouts, int rounds) {
  for (const auto& rollout : rollouts) rollout->WarmUp();
  for (int round = 0; round < rounds; ++round)
    for (const auto& rollout : rollouts) rollout->RunSlice();
}

Spread SpreadOf(std::vector<double> values) {
  DEX_CHECK(!values.empty());
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return {(values[(n - 1) / 2] + values[n / 2]) / 2, values.front(), values.back()};
}

Spread RatioOf(const std::vector<double>& a, const std::vector<double>& b) {
  DEX_CHECK_EQ(a.size(), b.size());
  std::vector<double> ratios;
  for (std::size_t i = 0; i < a.size(); ++i) ratios.push_back(a[i] / b[i]);
  return SpreadOf(std::move(ratios));
}

double HeapBytesPerEnv(const EngineSetting& setting, const HandModel& hand,
                       const SimObject& object) {
  constexpr int kFew = 64, kMany = 320;
  ThreadPool pool(1);
  const auto taken = [&](int num_envs) {
    const double before = HeapBytes();
    const auto sim = MakeBatchSim(setting.sim, hand, {object}, num_envs, pool);
    EnvState state;
    state.q.assign(hand.num_joints(), 0.0);
    state.qd = state.q;
    state.X_WO.p = {0, 0, 1};
    for (int env = 0; env < num_envs; ++env) sim->SetObject(env, 0, {}), sim->SetState(env, state);
    sim->Step(std::vector<double>(static_cast<std::size_t>(num_envs) * hand.num_joints(), 0.0));
    return HeapBytes() - before;
  };
  const double few = taken(kFew);
  return (taken(kMany) - few) / (kMany - kFew);
}

}  // namespace dexremoe
