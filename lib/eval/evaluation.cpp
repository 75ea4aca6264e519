#include "eval/evaluation.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/log.h"
#include "base/random.h"
#include "eval/outcome.h"
#include "shape/shape_files.h"

namespace dexremoe {
namespace {

Eigen::Quaterniond RotationOf(const ReorientBatch& batch, int env) {
  const double* q = &batch.sim_state().object_rotation[static_cast<std::size_t>(env) * 4];
  return {q[0], q[1], q[2], q[3]};
}

// A push every `every` control steps (at the decision that follows), in a direction that belongs to
// (object, episode, step).
void PushObjects(ReorientBatch& batch, const std::vector<EpisodeJob>& jobs,
                 const std::vector<int>& job_of_env, const std::vector<int>& age,
                 const PushOptions& push, std::uint64_t seed) {
  if (push.force <= 0) return;
  for (int env = 0; env < batch.num_envs(); ++env) {
    const bool due = age[env] / push.every > (age[env] - batch.action_repeat()) / push.every;
    if (job_of_env[env] < 0 || age[env] == 0 || !due) continue;
    const EpisodeJob& job = jobs[job_of_env[env]];
    Rng rng(seed, Stream::kDisturbance,
            {static_cast<std::uint64_t>(job.object), job.episode,
             static_cast<std::uint64_t>(age[env])});
    Eigen::Vector3d direction(rng.Normal(), rng.Normal(), rng.Normal());
    batch.Push(env, push.force * direction.normalized());
  }
}

// The clocks of all environments, a decision later.
void AdvanceClocks(const ReorientBatch& batch, std::vector<StillClock>& clocks) {
  const SimState& state = batch.sim_state();
  const std::size_t fingers = state.tip_contact.size() / clocks.size();
  for (std::size_t env = 0; env < clocks.size(); ++env)
    clocks[env].Advance(RotationOf(batch, static_cast<int>(env)),
                        {&state.tip_contact[env * fingers], fingers}, batch.action_repeat());
}

// `rows` rows of `width`, filled up with copies of the first row.
template <typename T>
std::vector<T> Padded(const std::vector<T>& from, std::size_t rows, std::size_t width) {
  std::vector<T> to = from;
  to.reserve(rows * width);
  while (to.size() < rows * width) to.insert(to.end(), from.begin(), from.begin() + width);
  return to;
}

}  // namespace

void EvalOptions::Register(Options& options) {
  options.Add("eval.episodes", &episodes, "episodes per object").Range(1, 1e6);
  options.Add("eval.envs", &envs, "environments run together; no effect on the result")
      .Range(1, 65536);
  options.Add("eval.tolerances", &tolerances, "success tolerances, rad; each has its own episodes")
      .Range(1e-3, 3.15);
  options.Add("eval.push", &push, "force of the pushes on the object, N; 0 = none").Range(0, 1000);
  options.Add("eval.push_every", &push_every, "control steps between pushes").Range(1, 1e6);
  options
      .Add("eval.category", &category,
           "what policies are told of an object's category: its label, the one that its shape is "
           "taken for, or the probabilities of all")
      .Choices({"label", "predicted", "soft"});
  options.Add("eval.resamples", &resamples, "bootstrap resamples for the intervals").Range(0, 1e6);
}

void SetCategoryInput(const std::string& choice, const std::vector<ObjectEntry>& entries,
                      std::vector<TaskObject>& objects) {
  DEX_CHECK_EQ(entries.size(), objects.size());
  if (choice == "label") return;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    std::vector<float> input = CategoryProbabilities(ReadShape(entries[i].folder + "/shape.h5"));
    if (choice == "predicted") {
      const auto best = std::max_element(input.begin(), input.end()) - input.begin();
      std::fill(input.begin(), input.end(), 0.0f);
      input[best] = 1;
    }
    objects[i].category_input = input;
  }
}

TaskOptions EvalTask(const EvalSetup& setup, double tolerance) {
  TaskOptions task = setup.task;
  task.tolerance = tolerance;
  task.goal_timeout = 0;
  task.near_share = 0;
  return task;
}

std::vector<EpisodeJob> MakeJobs(int objects, int episodes) {
  std::vector<EpisodeJob> jobs;
  for (int object = 0; object < objects; ++object)
    for (int e = 0; e < episodes; ++e) jobs.push_back({object, static_cast<std::uint64_t>(e)});
  return jobs;
}

ActFunction PolicyActions(PolicyRunner& runner) {
  return [&runner](const ReorientBatch& batch, std::vector<float>& actions) {
    constexpr std::size_t kBlock = 64;  // rows; from 16 on every row is computed alike
    const std::size_t rows = (batch.object().size() + kBlock - 1) / kBlock * kBlock;
    const std::size_t used = actions.size();
    runner.Act(Padded(batch.obs(), rows, runner.obs_size()),
               Padded(batch.phys(), rows, runner.phys_size()), Padded(batch.object(), rows, 1),
               actions);
    actions.resize(used);
  };
}

ActFunction HoldActions() {
  return [](const ReorientBatch&, std::vector<float>& actions) {
    std::fill(actions.begin(), actions.end(), 0.0f);
  };
}

std::vector<EpisodeRecord> RunJobs(ReorientBatch& batch, const ActFunction& act,
                                   const std::vector<EpisodeJob>& jobs, const PushOptions& push,
                                   std::uint64_t seed, const StepObserver& observer,
                                   const std::function<void(int)>& progress) {
  const int envs = batch.num_envs();
  const int count = static_cast<int>(jobs.size());
  DEX_CHECK_LE(envs, count);
  batch.set_auto_reset(false);
  std::vector<int> job_of_env(envs, -1), age(envs, 0);
  std::vector<StillClock> clocks(envs);
  int next = 0, done = 0;
  const auto start = [&](int env) {
    job_of_env[env] = next < count ? next++ : -1;
    age[env] = 0;
    if (job_of_env[env] >= 0) {
      const EpisodeJob& job = jobs[job_of_env[env]];
      batch.Reset(env, job.object, job.episode);
      clocks[env].Start(RotationOf(batch, env));
    }
  };
  for (int env = 0; env < envs; ++env) start(env);
  batch.TakeRecords();
  std::vector<EpisodeRecord> records(jobs.size());
  std::vector<float> actions(static_cast<std::size_t>(envs) * batch.num_joints());
  while (done < count) {
    act(batch, actions);
    PushObjects(batch, jobs, job_of_env, age, push, seed);
    if (observer.before) observer.before(batch, actions);
    const StepResult& result = batch.Step(actions);
    if (observer.after) observer.after(result);
    for (int& a : age) a += batch.action_repeat();
    AdvanceClocks(batch, clocks);
    for (EpisodeRecord& record : batch.TakeRecords()) {
      const int job = job_of_env[record.env];
      DEX_CHECK_GE(job, 0);
      record.object = jobs[job].object;
      record.episode = jobs[job].episode;
      record.still = clocks[record.env].still();
      records[job] = record;
      ++done;
      start(record.env);
    }
    if (progress) progress(done);
  }
  return records;
}

std::vector<EvalRun> Evaluate(const EvalSetup& setup, const EvalOptions& options,
                              const ActFunction& act, ThreadPool& pool) {
  const auto jobs = MakeJobs(static_cast<int>(setup.objects.size()), options.episodes);
  const int envs = std::min(options.envs, static_cast<int>(jobs.size()));
  std::vector<EvalRun> runs;
  for (const double tolerance : options.tolerances) {
    ReorientBatch batch(EvalTask(setup, tolerance), setup.sim, setup.hand, setup.objects, envs,
                        setup.seed, pool);
    Progress progress(fmt::format("episodes at {} rad", tolerance),
                      static_cast<double>(jobs.size()));
    EvalRun& run = runs.emplace_back();
    run.tolerance = tolerance;
    run.episodes = RunJobs(batch, act, jobs, {options.push, options.push_every}, setup.seed, {},
                           [&](int done) { progress.Update(done); });
    run.metrics = ComputeMetrics(run.episodes, {options.resamples, setup.seed});
  }
  return runs;
}

}  // namespace dexremoe
