// What e_phys shows besides the paper's numbers, and the goal as the policy sees it.
#include "task/observation.h"
#include "task_fixture.h"

namespace dexremoe {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// The numbers after the paper's 23 of the only environment.
std::vector<float> ExtrasOf(const FakeTask& task) {
  const auto& phys = task.batch->phys();
  return {phys.begin() + kPhysSize, phys.end()};
}

FakeTask TaskWith(std::vector<std::string> names) {
  TaskOptions options;
  options.extra_inputs = std::move(names);
  return FakeTask(options, 1);
}

TEST(ExtraInputs, GoalVectorTurnsTheObjectToItsGoal) {
  const FakeTask task = TaskWith({"goal_vector"});
  const std::vector<float> turn = ExtrasOf(task);
  ASSERT_EQ(turn.size(), 3u);
  const Vector3d v(turn[0], turn[1], turn[2]);
  const Quaterniond q_WO = task.sim->GetState(0).X_WO.q;
  const Quaterniond turned = Quaterniond(Eigen::AngleAxisd(v.norm(), v.normalized())) * q_WO;
  EXPECT_LT(RotationDistance(turned, GoalOf(*task.batch, 0)), 1e-5);
}

TEST(ExtraInputs, JointSpeedIsTheDifferenceOverAControlStep) {
  FakeTask task = TaskWith({"joint_speed"});
  EXPECT_EQ(ExtrasOf(task), (std::vector<float>{0, 0}));
  const std::vector<double> before = task.sim->GetState(0).q;
  task.Step(0.5, -0.5);
  const std::vector<double> after = task.sim->GetState(0).q;
  for (int j = 0; j < 2; ++j) EXPECT_NEAR(ExtrasOf(task)[j], 60 * (after[j] - before[j]), 1e-5);
}

TEST(ExtraInputs, TipPositionIsForwardKinematicsLessTheObject) {
  const FakeTask task = TaskWith({"tip_position"});
  const EnvState state = task.sim->GetState(0);
  const std::vector<Pose> X_WL = ForwardKinematics(TwoJointHand(), state.q.data());
  for (int f = 0; f < 2; ++f)
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(ExtrasOf(task)[3 * f + k], X_WL[f + 1].p[k] - state.X_WO.p[k], 1e-6);
}

TEST(ExtraInputs, ClockStartsAnewWithASuccess) {
  TaskOptions options;
  options.extra_inputs = {"wait_clock"};
  options.speed_max = options.spin_max = options.joint_speed_max = 1e6;
  FakeTask task(options, 1);
  for (int k = 0; k < kWaitPeriod / 4; ++k) task.Step();
  EXPECT_NEAR(ExtrasOf(task)[0], 1, 1e-6);  // a quarter of the period
  task.sim->script = [&](int, EnvState& s) { s.X_WO.q = GoalOf(*task.batch, 0); };
  task.Step();
  EXPECT_EQ(ExtrasOf(task), (std::vector<float>{0, 1}));
}

TEST(ExtraInputs, StandInOneOrderWhateverTheOptionSays) {
  const FakeTask one = TaskWith({"tip_contact", "goal_vector"});
  const FakeTask other = TaskWith({"goal_vector", "tip_contact"});
  EXPECT_EQ(ExtrasOf(one), ExtrasOf(other));
  EXPECT_EQ(one.batch->phys_size(), kPhysSize + 5);
}

TEST(ShownGoal, LiesOnTheWayToTheGoalAndNoFartherThanAsked) {
  TaskOptions options;
  options.goal_shown = 0.8;
  Rng rng(1, Stream::kTest);
  for (int k = 0; k < 200; ++k) {
    const auto a = rng.UnitQuaternion(), b = rng.UnitQuaternion();
    const Quaterniond q_WO(a[0], a[1], a[2], a[3]), q_WG(b[0], b[1], b[2], b[3]);
    const double angle = RotationDistance(q_WO, q_WG);
    const Quaterniond shown = internal::ShownGoal(options, q_WO, q_WG);
    EXPECT_NEAR(RotationDistance(q_WO, shown), std::min(angle, 0.8), 1e-9);
    EXPECT_NEAR(RotationDistance(shown, q_WG), std::max(angle - 0.8, 0.0), 1e-9);
  }
}

}  // namespace
}  // namespace dexremoe
