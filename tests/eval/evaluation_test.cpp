// Evaluation on the real task: cubes between the fingers of the GX11, in the ODE engine.
#include "eval/evaluation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "../sim/scenes.h"
#include "eval/outcome.h"
#include "rl/checkpoint.h"
#include "rl/start.h"

namespace dexremoe {
namespace {

TaskObject CubeObject(const std::string& name, double size) {
  TaskObject object;
  object.name = name;
  object.split = "train";
  object.sim = scenes::Cube(size);
  object.mass = 0.08;
  object.feature.assign(kShapeFeatureSize, 0.5f);
  Grasp grasp;
  grasp.q = {1.658, 0.258, 0.177, 0.942, 0.100, 0.514, 0.185, 1.554, 0.447, -0.450, 0.153};
  grasp.target = grasp.q;
  grasp.X_WO.p = {0.01, 0.07, 0.125};
  object.grasps = {grasp};
  return object;
}

EvalSetup SmallSetup() {
  EvalSetup setup;
  setup.task.episode_length = 40;
  setup.task.velocity_tolerance = 50;  // an untrained hand does not stop
  setup.hand = LoadHand(HandOptions());
  setup.objects = {CubeObject("small", 0.028), CubeObject("large", 0.034)};
  setup.seed = 5;
  return setup;
}

EvalOptions SmallOptions() {
  EvalOptions options;
  options.episodes = 3;
  options.envs = 4;
  options.tolerances = {2.2, 0.1};  // the first is met often, the second hardly ever
  options.resamples = 20;
  return options;
}

// Moves the joints as the observation says: the same for the same observation, in whatever row.
void Wriggle(const ReorientBatch& batch, std::vector<float>& actions) {
  const int joints = batch.num_joints(), width = batch.obs_size();
  for (int env = 0; env < batch.num_envs(); ++env)
    for (int j = 0; j < joints; ++j)
      actions[env * joints + j] =
          std::sin(9 * batch.obs()[env * width + 2 * joints + j] +
                   3 * batch.phys()[env * kPhysSize + 8] + static_cast<float>(j));
}

void ExpectEqual(const std::vector<EvalRun>& a, const std::vector<EvalRun>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t r = 0; r < a.size(); ++r) {
    ASSERT_EQ(a[r].episodes.size(), b[r].episodes.size());
    for (std::size_t i = 0; i < a[r].episodes.size(); ++i) {
      const EpisodeRecord &x = a[r].episodes[i], &y = b[r].episodes[i];
      EXPECT_EQ(x.object, y.object);
      EXPECT_EQ(x.episode, y.episode);
      EXPECT_EQ(x.length, y.length) << i;
      EXPECT_EQ(x.successes, y.successes) << i;
      EXPECT_EQ(x.end, y.end) << i;
      EXPECT_EQ(x.still, y.still) << i;
      EXPECT_EQ(x.total_reward, y.total_reward) << i;
      EXPECT_EQ(x.mean_angle, y.mean_angle) << i;
      EXPECT_EQ(x.mean_distance, y.mean_distance) << i;
    }
    EXPECT_EQ(a[r].metrics[Metric::kMean].high, b[r].metrics[Metric::kMean].high);
  }
}

TEST(Evaluation, EveryObjectGetsItsEpisodesInOrder) {
  ThreadPool pool(2);
  const auto runs = Evaluate(SmallSetup(), SmallOptions(), Wriggle, pool);
  ASSERT_EQ(runs.size(), 2u);
  for (const EvalRun& run : runs) {
    ASSERT_EQ(run.episodes.size(), 6u);
    for (int i = 0; i < 6; ++i) {
      EXPECT_EQ(run.episodes[i].object, i / 3);
      EXPECT_EQ(run.episodes[i].episode, static_cast<std::uint64_t>(i % 3));
      EXPECT_GT(run.episodes[i].length, 0);
      EXPECT_NE(run.episodes[i].end, EpisodeEnd::kNone);
      EXPECT_EQ(run.episodes[i].end == EpisodeEnd::kTimeout, run.episodes[i].length == 40);
    }
  }
  // The wide tolerance is met, so that the tests below compare more than zeros.
  EXPECT_GT(runs[0].metrics[Metric::kMean].value, 0);
  EXPECT_GT(runs[0].metrics[Metric::kMean].value, runs[1].metrics[Metric::kMean].value);
}

TEST(Evaluation, ResultsDependNeitherOnEnvironmentsNorOnWorkers) {
  ThreadPool one(1), three(3);
  EvalOptions options = SmallOptions();
  options.push = 0.3;
  options.push_every = 7;
  const auto reference = Evaluate(SmallSetup(), options, Wriggle, one);
  for (const int envs : {1, 5, 256}) {
    options.envs = envs;
    ExpectEqual(reference, Evaluate(SmallSetup(), options, Wriggle, three));
  }
}

// Matrix products of a few rows are rounded otherwise than those of many; a chaotic episode shows
// it.
TEST(Evaluation, APolicysResultsDoNotDependOnTheBatchEither) {
  const std::string path =
      (std::filesystem::path(::testing::TempDir()) / "eval_policy.h5").string();
  const EvalSetup setup = SmallSetup();
  StageStart start{{}, {}, MakeShapeTable(setup.objects), 3};
  PolicyOptions policy;
  policy.hidden = 64;
  TrainState state = StartBase(start, policy, 66, kPhysSize, 11);
  for (float& p : state.params) p *= 3;  // so that the hand moves
  WriteCheckpoint(path, state, {"test", "", 3, {}});
  ThreadPool one(1), two(2);
  PolicyRunner runner(path, setup.objects, one);
  EvalOptions options = SmallOptions();
  const auto reference = Evaluate(setup, options, PolicyActions(runner), one);
  for (const int envs : {1, 2, 6}) {
    options.envs = envs;
    ExpectEqual(reference, Evaluate(setup, options, PolicyActions(runner), two));
  }
  std::filesystem::remove(path);
}

TEST(Evaluation, PushesMoveTheObject) {
  ThreadPool pool(2);
  EvalOptions options = SmallOptions();
  const auto calm = Evaluate(SmallSetup(), options, Wriggle, pool);
  options.push = 2;
  options.push_every = 5;
  const auto pushed = Evaluate(SmallSetup(), options, Wriggle, pool);
  int changed = 0;
  for (int i = 0; i < 6; ++i)
    changed += calm[0].episodes[i].mean_distance != pushed[0].episodes[i].mean_distance;
  EXPECT_GE(changed, 5);
}

TEST(Evaluation, ATraceIsTheEpisodeThatWasEvaluated) {
  ThreadPool pool(2);
  const EvalSetup setup = SmallSetup();
  const EvalOptions options = SmallOptions();
  const auto runs = Evaluate(setup, options, Wriggle, pool);
  const auto jobs = ChooseEpisodes(runs[0], 3, "best");
  const std::vector<float> gates = {0.25f, 0.75f, 0.5f, 0.5f};  // two objects, two experts
  const auto traces = RecordEpisodes(setup, options, runs[0], jobs, Wriggle, gates, pool);
  ASSERT_EQ(traces.size(), 3u);
  for (std::size_t i = 0; i < traces.size(); ++i) {
    const EpisodeTrace& trace = traces[i];
    const EpisodeRecord& record = *std::find_if(
        runs[0].episodes.begin(), runs[0].episodes.end(),
        [&](const auto& e) { return e.object == jobs[i].object && e.episode == jobs[i].episode; });
    EXPECT_EQ(trace.object, setup.objects[record.object].name);
    EXPECT_EQ(trace.length(), record.length);
    EXPECT_EQ(std::count(trace.success.begin(), trace.success.end(), 1), record.successes);
    EXPECT_EQ(trace.end, OutcomeName(OutcomeOf(record)));
    EXPECT_EQ(trace.joint_position.size(), trace.angle.size() * 11);
    EXPECT_EQ(trace.object_rotation.size(), trace.angle.size() * 4);
    EXPECT_EQ(trace.action.size(), trace.angle.size() * 11);
    EXPECT_EQ(trace.gate.size(), trace.angle.size() * 2);
    EXPECT_EQ(trace.gate[0], gates[2 * record.object]);
    for (int t = 0; t < trace.length(); ++t) {
      // The stored angle is the one between the stored orientations.
      double dot = 0;
      for (int k = 0; k < 4; ++k)
        dot += trace.object_rotation[4 * t + k] * trace.goal_rotation[4 * t + k];
      EXPECT_NEAR(trace.angle[t], 2 * std::acos(std::min(1.0, std::abs(dot))), 1e-5);
      // A success switches the goal of the next row, and nothing else does.
      if (t + 1 == trace.length()) break;
      EXPECT_EQ(trace.success[t] == 1,
                !std::equal(&trace.goal_rotation[4 * t], &trace.goal_rotation[4 * t] + 4,
                            &trace.goal_rotation[4 * (t + 1)]));
    }
  }
}

TEST(ChooseEpisodes, TakesEachObjectOnceBeforeAnyTwice) {
  EvalRun run;
  for (int o = 0; o < 3; ++o)
    for (int e = 0; e < 4; ++e) {
      EpisodeRecord r;
      r.object = o;
      r.episode = static_cast<std::uint64_t>(e);
      r.successes = o == 1 ? 10 + e : e;
      r.length = 100 + o;
      run.episodes.push_back(r);
    }
  const auto best = ChooseEpisodes(run, 4, "best");
  ASSERT_EQ(best.size(), 4u);
  EXPECT_EQ(best[0].object, 1);
  EXPECT_EQ(best[0].episode, 3u);
  EXPECT_EQ(best[1].object, 2);  // of two with three successes the longer
  EXPECT_EQ(best[2].object, 0);
  EXPECT_EQ(best[3].object, 1);
  EXPECT_EQ(best[3].episode, 2u);
  const auto worst = ChooseEpisodes(run, 2, "worst");
  EXPECT_EQ(worst[0].object, 0);
  EXPECT_EQ(worst[0].episode, 0u);
  EXPECT_EQ(worst[1].object, 2);
  const auto first = ChooseEpisodes(run, 3, "first");
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(first[i].object, i);
    EXPECT_EQ(first[i].episode, 0u);
  }
  EXPECT_EQ(ChooseEpisodes(run, 100, "best").size(), 12u);
}

}  // namespace
}  // namespace dexremoe
