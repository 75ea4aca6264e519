// Replays chosen episodes and keeps every control step.
#include <algorithm>
#include <array>
#include <set>

#include "base/check.h"
#include "base/error.h"
#include "eval/evaluation.h"
#include "eval/outcome.h"

namespace dexremoe {
namespace {

template <typename T, typename U>
void AppendRow(std::vector<T>& into, const std::vector<U>& from, int row, int width) {
  for (int k = 0; k < width; ++k)
    into.push_back(static_cast<T>(from[static_cast<std::size_t>(row) * width + k]));
}

void RecordRow(const ReorientBatch& batch, const std::vector<float>& actions,
               const std::vector<float>& gates, int env, EpisodeTrace& trace) {
  const SimState& state = batch.sim_state();
  const int joints = batch.num_joints();
  if (trace.length() == 0) trace.scale = batch.physics(env).scale;
  AppendRow(trace.joint_position, state.joint_position, env, joints);
  AppendRow(trace.object_position, state.object_position, env, 3);
  AppendRow(trace.object_rotation, state.object_rotation, env, 4);
  for (const double x : batch.goal()[env]) trace.goal_rotation.push_back(x);
  trace.angle.push_back(batch.angle()[env]);
  AppendRow(trace.action, actions, env, joints);
  const auto experts = static_cast<int>(gates.size() / batch.objects().size());
  AppendRow(trace.gate, gates, batch.object()[env], experts);
}

const EpisodeRecord* FindRecord(const EvalRun& run, const EpisodeJob& job) {
  for (const EpisodeRecord& e : run.episodes)
    if (e.object == job.object && e.episode == job.episode) return &e;
  return nullptr;
}

// Names the episodes and checks that each went as it did in the evaluation.
void Describe(const EvalSetup& setup, const EvalRun& run,
              const std::vector<EpisodeRecord>& replayed, std::vector<EpisodeTrace>& traces) {
  for (std::size_t i = 0; i < traces.size(); ++i) {
    const EpisodeRecord& again = replayed[i];
    const TaskObject& object = setup.objects[again.object];
    const EpisodeRecord* first = FindRecord(run, {again.object, again.episode});
    if (first != nullptr && (first->length != again.length || first->successes != again.successes))
      Fail(
          "trace of {} episode {}: expected {} steps and {} successes as evaluated, found {} and "
          "{}",
          object.name, again.episode, first->length, first->successes, again.length,
          again.successes);
    traces[i].object = object.name;
    traces[i].category = kCategories[object.category];
    traces[i].episode = again.episode;
    traces[i].end = OutcomeName(OutcomeOf(again));
    traces[i].successes = again.successes;
  }
}

// See ChooseEpisodes.
EpisodeJob TypicalEpisode(const EvalRun& run, int object) {
  std::array<std::vector<const EpisodeRecord*>, kNumOutcomes> by_outcome;
  std::vector<const EpisodeRecord*> all;
  for (const EpisodeRecord& e : run.episodes) {
    if (e.object != object) continue;
    by_outcome[static_cast<std::size_t>(OutcomeOf(e))].push_back(&e);
    all.push_back(&e);
  }
  const auto& falls = by_outcome[static_cast<std::size_t>(Outcome::kFall)];
  const auto& jams = by_outcome[static_cast<std::size_t>(Outcome::kJam)];
  std::vector<const EpisodeRecord*> kind = falls.size() >= jams.size() ? falls : jams;
  if (kind.empty()) kind = all;
  std::stable_sort(kind.begin(), kind.end(),
                   [](const auto* a, const auto* b) { return a->length < b->length; });
  return {object, kind[kind.size() / 2]->episode};
}

std::vector<EpisodeJob> TypicalEpisodes(const EvalRun& run, int count) {
  std::vector<const ObjectMetrics*> order;
  for (const ObjectMetrics& m : run.metrics.objects) order.push_back(&m);
  std::stable_sort(order.begin(), order.end(), [](const auto* a, const auto* b) {
    return (*a)[ObjectMetric::kSuccesses].value < (*b)[ObjectMetric::kSuccesses].value;
  });
  std::vector<EpisodeJob> chosen;
  for (const ObjectMetrics* m : order)
    if (static_cast<int>(chosen.size()) < count) chosen.push_back(TypicalEpisode(run, m->object));
  return chosen;
}

}  // namespace

std::vector<EpisodeJob> ChooseEpisodes(const EvalRun& run, int count, const std::string& choice) {
  if (choice == "typical") return TypicalEpisodes(run, count);
  std::vector<const EpisodeRecord*> order;
  for (const EpisodeRecord& e : run.episodes) order.push_back(&e);
  if (choice == "best")
    std::stable_sort(order.begin(), order.end(), [](const auto* a, const auto* b) {
      return a->successes != b->successes ? a->successes > b->successes : a->length > b->length;
    });
  if (choice == "worst")
    std::stable_sort(order.begin(), order.end(),
                     [](const auto* a, const auto* b) { return a->successes < b->successes; });
  // Rounds over the objects: the first episode of each, then the second of each, and so on.
  std::vector<EpisodeJob> chosen;
  std::vector<bool> taken(order.size(), false);
  while (static_cast<int>(chosen.size()) < count && chosen.size() < order.size()) {
    std::set<int> seen;
    for (std::size_t i = 0; i < order.size() && static_cast<int>(chosen.size()) < count; ++i) {
      if (taken[i] || !seen.insert(order[i]->object).second) continue;
      taken[i] = true;
      chosen.push_back({order[i]->object, order[i]->episode});
    }
  }
  return chosen;
}

std::vector<EpisodeTrace> RecordEpisodes(const EvalSetup& setup, const EvalOptions& options,
                                         const EvalRun& run, const std::vector<EpisodeJob>& jobs,
                                         const ActFunction& act, const std::vector<float>& gates,
                                         ThreadPool& pool) {
  if (jobs.empty()) return {};
  const int count = static_cast<int>(jobs.size());
  ReorientBatch batch(EvalTask(setup, run.tolerance), setup.sim, setup.hand, setup.objects, count,
                      setup.seed, pool);
  std::vector<EpisodeTrace> traces(jobs.size());
  std::vector<bool> alive(jobs.size(), true);
  StepObserver observer;
  observer.before = [&](const ReorientBatch& now, const std::vector<float>& actions) {
    for (int env = 0; env < count; ++env)
      if (alive[env]) RecordRow(now, actions, gates, env, traces[env]);
  };
  observer.after = [&](const StepResult& result) {
    for (int env = 0; env < count; ++env) {
      if (!alive[env]) continue;
      traces[env].success.push_back(result.success[env]);
      alive[env] = result.end[env] == EpisodeEnd::kNone;
    }
  };
  // As many environments as jobs: environment e plays job e and stops.
  const auto replayed =
      RunJobs(batch, act, jobs, {options.push, options.push_every}, setup.seed, observer);
  Describe(setup, run, replayed, traces);
  return traces;
}

}  // namespace dexremoe
