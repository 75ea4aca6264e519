// Actions that last several control steps, and episodes that fail when nothing succeeds.
#include <algorithm>

#include "task_fixture.h"

namespace dexremoe {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// The object turns and sinks a little in every control step.
void Drift(int, EnvState& s) {
  s.X_WO.p.z() += 0.001;
  s.X_WO.q = (Quaterniond(Eigen::AngleAxisd(0.01, Vector3d::UnitX())) * s.X_WO.q).normalized();
}

TEST(Decision, ThatLastsThreeStepsEqualsThreeStepsOfTheSameAction) {
  TaskOptions options;
  options.ema = 0.5;
  FakeTask single(options, 2);
  options.action_repeat = 3;
  FakeTask triple(options, 2);
  single.sim->script = triple.sim->script = Drift;
  double reward = 0;
  for (int k = 0; k < 3; ++k) reward += single.Step(0.3f, -0.2f).reward[1];
  EXPECT_NEAR(triple.Step(0.3f, -0.2f).reward[1], reward, 1e-6);
  EXPECT_EQ(triple.sim->steps[1], 3);
  EXPECT_EQ(triple.batch->targets(), single.batch->targets());
  EXPECT_EQ(triple.batch->angle(), single.batch->angle());
  EXPECT_EQ(triple.batch->phys(), single.batch->phys());
}

TEST(Decision, HistoryCountsDecisions) {
  TaskOptions options;
  options.action_repeat = 3;
  FakeTask task(options, 1);
  const float before = task.batch->obs()[4];  // joint 0 at t
  task.Step(1, 0);
  EXPECT_EQ(task.batch->obs()[2], before);  // at t - 1
  EXPECT_GT(task.batch->obs()[4], before);
}

TEST(Decision, EndsWithTheEpisodeInsideIt) {
  TaskOptions options;
  options.action_repeat = 4;
  FakeTask task(options, 2);
  int calls = 0;
  task.sim->script = [&](int env, EnvState& s) {
    if (env == 1 && ++calls == 2) s.X_WO.p.z() += 0.2;
  };
  EXPECT_EQ(task.Step().end[1], EpisodeEnd::kFall);
  EXPECT_EQ(calls, 2);
  const auto records = task.batch->TakeRecords();
  ASSERT_EQ(records.size(), 1u);
  EXPECT_EQ(records[0].length, 2);
}

TEST(Decision, ClockEndsAnEpisodeOnItsControlStep) {
  TaskOptions options;
  options.action_repeat = 3;
  options.episode_length = 5;
  FakeTask task(options, 1);
  task.Step();
  EXPECT_EQ(task.Step().end[0], EpisodeEnd::kTimeout);
  EXPECT_EQ(task.batch->TakeRecords().front().length, 5);
}

TEST(Jam, FailsAnEpisodeWithoutSuccessAndIsPaidFor) {
  TaskOptions options;
  options.goal_timeout = 3;
  FakeTask plain(options, 1);
  options.c_jam = -70;
  FakeTask task(options, 1);
  for (int k = 0; k < 2; ++k) EXPECT_EQ((plain.Step(), task.Step().end[0]), EpisodeEnd::kNone);
  const double unpaid = plain.Step().reward[0];
  const StepResult& result = task.Step();
  EXPECT_EQ(result.end[0], EpisodeEnd::kJam);
  EXPECT_NEAR(result.reward[0], unpaid - 0.7, 1e-6);
}

TEST(Jam, WaitsAnewAfterASuccess) {
  TaskOptions options;
  options.goal_timeout = 3;
  options.speed_max = options.spin_max = options.joint_speed_max = 1e6;
  FakeTask task(options, 1);
  task.Step();
  task.sim->script = [&](int, EnvState& s) { s.X_WO.q = GoalOf(*task.batch, 0); };
  EXPECT_TRUE(task.Step().success[0]);
  task.sim->script = nullptr;
  EXPECT_EQ(task.Step().end[0], EpisodeEnd::kNone);
  EXPECT_EQ(task.Step().end[0], EpisodeEnd::kNone);
  EXPECT_EQ(task.Step().end[0], EpisodeEnd::kJam);
}

TEST(Jam, DoesNotHideAFall) {
  TaskOptions options;
  options.goal_timeout = 1;
  FakeTask task(options, 1);
  task.sim->script = [](int, EnvState& s) { s.X_WO.p.z() += 0.2; };
  EXPECT_EQ(task.Step().end[0], EpisodeEnd::kFall);
}

TEST(NearGoals, AreTheAskedShareWhateverTheWidestGoal) {
  TaskOptions options;
  options.near_share = 0.4;
  options.near_angle = 0.9;
  const int envs = 4000;
  FakeTask task(options, envs);
  const auto& angle = task.batch->angle();
  const auto near = std::count_if(angle.begin(), angle.end(), [](double a) { return a <= 0.9; });
  // Haar-uniform goals lie within 0.9 rad with probability (0.9 - sin 0.9) / pi.
  const double expected = 0.4 + 0.6 * (0.9 - std::sin(0.9)) / M_PI;
  EXPECT_NEAR(static_cast<double>(near) / envs, expected, 4 * std::sqrt(0.25 / envs));
}

}  // namespace
}  // namespace dexremoe
