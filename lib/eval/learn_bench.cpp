#include "eval/learn_bench.h"

#include <algorithm>

#include "eval/learn_bench_machine.h"
#include "policy/policy.h"
#include "policy/shape_table.h"
#include "rl/inference.h"
#include "rl/ppo.h"
#include "rl/reorient_env.h"
#include "rl/rollout.h"
#include "rl/start.h"

namespace dexremoe {
namespace {

// The object as training knows it. Its descriptor is zero, which is what normalisation over one
// object makes of any.
TaskObject ForTask(const GraspedObject& object, const TaskOptions& task) {
  TaskObject result;
  result.name = object.sim.name;
  result.split = "train";
  result.sim = object.sim;
  result.mass = (task.mass_range[0] + task.mass_range[1]) / 2;
  result.grasps = object.grasps;
  result.feature.assign(kShapeFeatureSize, 0.0f);
  return result;
}

}  // namespace

void LearnBenchOptions::Register(Options& options) {
  options.Add("precision", &precision, "of the networks").Choices({"f32", "bf16"});
  options.Add("envs", &envs, "numbers of environments").Range(1, 1 << 20);
  options.Add("mini_epochs", &mini_epochs, "passes over a batch").Range(1, 100);
  options.Add("more_epochs", &more_epochs, "other numbers of passes, with --more_epochs_envs alone")
      .Range(1, 100);
  options.Add("more_epochs_envs", &more_epochs_envs, "environments").Range(1, 1 << 20);
  options.Add("paper", &paper, "time one iteration of the paper's size, too");
  options.Add("horizon", &horizon, "steps per environment and iteration").Range(1, 4096);
  options.Add("minibatch", &minibatch, "rows per optimiser step, at most those of a batch")
      .Range(1, 1 << 24);
  options.Add("hidden", &hidden, "width of the policy's hidden layers").Range(1, 8192);
  options.Add("slices", &slices, "time slices of each part").Range(1, 1000);
  options.Add("slice", &slice, "seconds of a time slice; at least one iteration").Range(0, 60);
  options.Add("peer", &peer, "program that times the update on libtorch").NotStored();
  options
      .Add("assumed_peaks", &assumed_peaks,
           "bfloat16 rates of another core, GFLOP/s, to work out its limit for")
      .Range(1, 1e6);
  options.Add("seed", &seed, "of all random numbers");
}

void LearnBenchOptions::MakeQuick() {
  envs = {64, 128};
  mini_epochs = 2;
  more_epochs = {1};
  more_epochs_envs = 64;
  paper = false;
  minibatch = 512;
  hidden = 32;
  slices = 2;
  slice = 0.02;
}

std::vector<LearnBenchCase> LearnBenchOptions::Cases() const {
  std::vector<LearnBenchCase> cases;
  for (const std::string& p : precision) {
    for (const int n : envs)
      cases.push_back({Ppo(n, mini_epochs, p), slices, !peer.empty(), false});
    for (const int epochs : more_epochs)
      cases.push_back({Ppo(more_epochs_envs, epochs, p), slices, false, false});
    if (!paper) continue;
    PpoOptions papers;
    papers.precision = p;
    cases.push_back({papers, 1, false, true});
  }
  return cases;
}

PpoOptions LearnBenchOptions::Ppo(int num_envs, int epochs, const std::string& in_precision) const {
  PpoOptions ppo;
  ppo.precision = in_precision;
  ppo.envs = num_envs;
  ppo.horizon = horizon;
  ppo.minibatch =
      static_cast<int>(std::min<std::int64_t>(minibatch, std::int64_t{num_envs} * horizon));
  ppo.mini_epochs = epochs;
  return ppo;
}

PolicyOptions LearnBenchOptions::Policy() const {
  PolicyOptions policy;
  policy.hidden = hidden;
  return policy;
}

void SliceTimes::Add(const Cost& cost, int count) {
  wall.push_back(cost.wall / count);
  cpu.push_back(cost.cpu / count);
}

std::vector<double> RatesOf(double work, const std::vector<double>& seconds) {
  std::vector<double> rates;
  for (const double s : seconds) rates.push_back(work / s);
  return rates;
}

struct TimedTraining::Impl {
  Impl(const PpoOptions& options, const PolicyOptions& structure, const HandModel& hand,
       const TaskOptions& task, const TaskObject& object, std::uint64_t seed, ThreadPool& pool)
      : ppo(options),
        batch(task, SettingOf(SimOptions(), "lanes", 2).sim, hand, {object}, ppo.envs, seed, pool),
        env(batch),
        state(StartBase({ppo, {}, MakeShapeTable({object}), seed}, structure, env.obs_size(),
                        env.phys_size(), env.num_actions())),
        policy(MakePolicy<float>(state.structure)),
        shapes(state.table, state.normalizers.feature, state.normalizers.clip,
               state.structure.num_categories),
        rollout(ppo, *policy, env, pool),
        learner(ppo, *policy, pool),
        inference(*policy, pool),
        mean(static_cast<std::size_t>(ppo.envs) * env.num_actions()),
        value(ppo.envs) {
    env.ResetAll();
  }

  void Iterate(Cost& collecting, Cost& updating);
  void Forward();

  PpoOptions ppo;
  ReorientBatch batch;
  ReorientEnv env;
  TrainState state;
  std::unique_ptr<Policy<float>> policy;
  ShapeRows shapes;
  Rollout rollout;
  PpoLearner learner;
  Inference inference;
  std::vector<float> mean, value;
  SliceTimes forward_times, update_times, iteration_times;
};

// As Trainer::Iterate, without figures and curriculum.
void TimedTraining::Impl::Iterate(Cost& collecting, Cost& updating) {
  const Stopwatch collect;
  RunningMoments obs = state.normalizers.obs, phys = state.normalizers.phys;
  const RolloutBatch& rows = rollout.Collect(state, shapes.inputs(), &obs, &phys);
  collecting += collect.Read();
  const Stopwatch update;
  learner.Update(rows, shapes.inputs(), state);
  updating += update.Read();
  state.normalizers.obs = std::move(obs);
  state.normalizers.phys = std::move(phys);
  ++state.iteration;
}

void TimedTraining::Impl::Forward() {
  inference.Run(state.params, shapes.inputs(),
                {ppo.envs, env.obs().data(), env.phys().data(), env.object().data(), nullptr},
                {mean.data(), value.data(), nullptr});
}

TimedTraining::TimedTraining(const PpoOptions& ppo, const PolicyOptions& policy,
                             const HandModel& hand, const TaskOptions& task,
                             const GraspedObject& object, std::uint64_t seed, ThreadPool& pool)
    : impl_(std::make_unique<Impl>(ppo, policy, hand, task, ForTask(object, task), seed, pool)) {}

TimedTraining::~TimedTraining() = default;

void TimedTraining::WarmUp() {
  Cost ignored;
  impl_->Iterate(ignored, ignored);
}

void TimedTraining::RunSlice(double seconds) {
  Cost collecting, updating, forward;
  int iterations = 0, passes = 0;
  for (; iterations == 0 || collecting.wall + updating.wall < seconds; ++iterations)
    impl_->Iterate(collecting, updating);
  for (; passes == 0 || forward.wall < seconds; ++passes) {
    const Stopwatch pass;
    impl_->Forward();
    forward += pass.Read();
  }
  impl_->update_times.Add(updating, iterations);
  collecting += updating;
  impl_->iteration_times.Add(collecting, iterations);
  impl_->forward_times.Add(forward, passes);
}

double TimedTraining::samples() const {
  return static_cast<double>(impl_->ppo.envs) * impl_->ppo.horizon;
}

const ParamLayout& TimedTraining::layout() const { return impl_->policy->layout(); }
const SliceTimes& TimedTraining::forward() const { return impl_->forward_times; }
const SliceTimes& TimedTraining::update() const { return impl_->update_times; }
const SliceTimes& TimedTraining::iteration() const { return impl_->iteration_times; }

}  // namespace dexremoe
