// The task on a scripted simulator.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "task_fixture.h"

namespace dexremoe {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// Joint limits are -1..1 and -1..3.
float Scaled0(double q) { return static_cast<float>(q); }
float Scaled1(double q) { return static_cast<float>((2 * q - 2) / 4); }

TEST(Observation, ShowsThreeAnglesAndThreeExecutedActionsOldestFirst) {
  TaskOptions options;
  options.ema = 0.5;
  options.action_scale = 0.1;
  FakeTask task(options, 1);
  std::vector<double> q0 = {task.sim->state().joint_position[0]};
  EXPECT_EQ(task.batch->obs_size(), 12);
  std::vector<std::array<double, 2>> q;
  const auto record = [&] {
    const auto& p = task.sim->state().joint_position;
    q.push_back({p[0], p[1]});
  };
  record();
  for (const float a : {1.0f, -1.0f, 0.5f, 3.0f}) {
    task.Step(a, -a);
    record();
  }
  const auto& obs = task.batch->obs();
  for (int place = 0; place < 3; ++place) {
    EXPECT_FLOAT_EQ(obs[2 * place], Scaled0(q[2 + place][0]));
    EXPECT_FLOAT_EQ(obs[2 * place + 1], Scaled1(q[2 + place][1]));
  }
  // Moving averages of 1, -1, 0.5 and 3 (clamped to 1) from 0: 0.5, -0.25, 0.125, 0.5625.
  const float expected[] = {-0.25f, 0.125f, 0.5625f};
  for (int place = 0; place < 3; ++place) {
    EXPECT_FLOAT_EQ(obs[6 + 2 * place], expected[place]);
    EXPECT_FLOAT_EQ(obs[6 + 2 * place + 1], -expected[place]);
  }
}

TEST(Observation, MayShowTargetsInstead) {
  TaskOptions options;
  options.observe = "target";
  FakeTask task(options, 1);
  const Grasp& grasp = task.batch->objects()[0].grasps[0];
  EXPECT_NEAR(grasp.target[1], 0.6, 1e-12);
  for (int place = 0; place < 3; ++place)
    EXPECT_FLOAT_EQ(task.batch->obs()[6 + 2 * place + 1], Scaled1(0.6));
  task.Step(0, 1);
  EXPECT_FLOAT_EQ(task.batch->obs()[11], Scaled1(task.batch->targets()[1]));
  EXPECT_FLOAT_EQ(task.batch->obs()[9], Scaled1(0.6));
}

TEST(Observation, StartsWithTheGraspInEveryPlaceAndNoAction) {
  FakeTask task({}, 1);
  const auto& obs = task.batch->obs();
  for (int place = 0; place < 3; ++place) {
    EXPECT_FLOAT_EQ(obs[2 * place + 1], Scaled1(0.5));
    EXPECT_EQ(obs[6 + 2 * place], 0);
    EXPECT_EQ(obs[6 + 2 * place + 1], 0);
  }
}

TEST(Phys, HoldsThePapersListAndTheRelativeGoal) {
  TaskOptions options;
  options.com_range = {-0.01, 0.01};
  FakeTask task(options, 1);
  const Vector3d step(0.0001, -0.0002, 0.0003);
  const Vector3d turn(0.002, 0.001, -0.003);
  const Quaterniond dq(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  task.sim->script = [&](int, EnvState& s) {
    s.X_WO.p += step;
    s.X_WO.q = Quaterniond(-(dq * s.X_WO.q).coeffs());  // the sign of q must not matter
  };
  task.Step();
  const EnvPhysics& physics = task.sim->physics[0];
  const EnvState state = task.sim->GetState(0);
  const Quaterniond q = Canonical(state.X_WO.q);
  const Quaterniond relative = Canonical(state.X_WO.q * GoalOf(*task.batch, 0).conjugate());
  const Vector3d v = 60 * step, w = 60 * turn;
  const double expected[] = {physics.mass,
                             physics.com.x(),
                             physics.com.y(),
                             physics.com.z(),
                             physics.friction,
                             physics.scale,
                             state.X_WO.p.x(),
                             state.X_WO.p.y(),
                             state.X_WO.p.z(),
                             q.w(),
                             q.x(),
                             q.y(),
                             q.z(),
                             v.x(),
                             v.y(),
                             v.z(),
                             w.x(),
                             w.y(),
                             w.z(),
                             relative.w(),
                             relative.x(),
                             relative.y(),
                             relative.z()};
  static_assert(std::size(expected) == kPhysSize);
  for (int i = 0; i < kPhysSize; ++i) EXPECT_NEAR(task.batch->phys()[i], expected[i], 1e-6) << i;
  EXPECT_NE(physics.com.x(), 0);
}

TEST(Targets, MoveByTheActionWithinLeashAndLimits) {
  TaskOptions options;
  options.action_scale = 0.1;
  options.target_leash = 0.15;
  FakeTask task(options, 1);
  // Joints that do not move: the leash holds the target.
  const EnvState start = task.sim->GetState(0);
  task.sim->script = [&](int, EnvState& s) { s.q = start.q; };
  task.Step(-1, 1);
  EXPECT_NEAR(task.batch->targets()[0], start.q[0] + 0.1 - 0.1, 1e-12);  // grasp target q + 0.1
  for (int k = 0; k < 3; ++k) task.Step(-1, 1);
  EXPECT_NEAR(task.batch->targets()[0], start.q[0] - 0.15, 1e-12);
  EXPECT_NEAR(task.batch->targets()[1], start.q[1] + 0.15, 1e-12);
  // Joints that follow: the limits hold it.
  task.sim->script = nullptr;
  for (int k = 0; k < 60; ++k) task.Step(-1, 1);
  EXPECT_EQ(task.batch->targets()[0], -1);
  EXPECT_EQ(task.batch->targets()[1], 3);
}

TEST(Episode, AverageStartsAtZeroAgain) {
  TaskOptions options;
  options.ema = 0.1;
  options.episode_length = 5;
  FakeTask task(options, 1);
  for (int k = 0; k < 5; ++k) task.Step(1, 1);
  EXPECT_EQ(task.batch->TakeRecords().size(), 1u);
  task.Step(1, 1);
  EXPECT_FLOAT_EQ(task.batch->obs()[10], 0.1f);
}

TEST(Success, NeedsTheHoldAndRedrawsTheGoalButLeavesObjectAndClock) {
  TaskOptions options;
  options.hold_steps = 3;
  FakeTask task(options, 1);
  Quaterniond at = GoalOf(*task.batch, 0);
  const Quaterniond first = at;
  task.sim->script = [&](int, EnvState& s) { s.X_WO.q = at; };
  task.Step();  // arrives too fast
  EXPECT_EQ(task.batch->angle()[0], 0);
  for (int k = 0; k < 2; ++k) EXPECT_EQ(task.Step().success[0], 0);
  const StepResult& result = task.Step();
  EXPECT_EQ(result.success[0], 1);
  EXPECT_EQ(result.end[0], EpisodeEnd::kNone);
  EXPECT_GT(result.reward[0], 8);
  const Quaterniond second = GoalOf(*task.batch, 0);
  EXPECT_GT(RotationDistance(first, second), 0.01);
  EXPECT_NEAR(task.batch->angle()[0], RotationDistance(at, second), 1e-12);
  EXPECT_LT(RotationDistance(task.sim->GetState(0).X_WO.q, first), 1e-9);
  at = second;
  task.Step();
  for (int k = 0; k < 3; ++k) task.Step();
  for (int k = 0; k < 592; ++k) task.Step();
  const auto records = task.batch->TakeRecords();
  ASSERT_EQ(records.size(), 1u);
  EXPECT_EQ(records[0].successes, 2);
  EXPECT_EQ(records[0].length, 600);
  EXPECT_EQ(records[0].end, EpisodeEnd::kTimeout);
}

TEST(Success, AnInterruptedHoldStartsAgain) {
  TaskOptions options;
  options.hold_steps = 2;
  FakeTask task(options, 1);
  const Quaterniond goal = GoalOf(*task.batch, 0);
  double shift = 0;
  task.sim->script = [&](int, EnvState& s) {
    s.X_WO.q = goal;
    s.X_WO.p.x() += shift;
  };
  task.Step();
  EXPECT_EQ(task.Step().success[0], 0);
  shift = 0.001;  // 0.06 m/s
  EXPECT_EQ(task.Step().success[0], 0);
  shift = 0;
  EXPECT_EQ(task.Step().success[0], 0);
  EXPECT_EQ(task.Step().success[0], 1);
}

TEST(Episode, EndsByFallWithTheLastObservationAndTheRecord) {
  TaskOptions options;
  options.c_fall = -50;
  FakeTask task(options, 3);
  task.sim->script = [&](int env, EnvState& s) {
    if (env == 1) s.X_WO.p.z() += 0.2;
  };
  const double distance =
      (task.sim->GetState(1).X_WO.p + Vector3d(0, 0, 0.2) - Vector3d(options.grasp_center.data()))
          .norm();
  const StepResult& result = task.Step();
  EXPECT_EQ(result.end, (std::vector{EpisodeEnd::kNone, EpisodeEnd::kFall, EpisodeEnd::kNone}));
  EXPECT_EQ(result.ended, std::vector<int>{1});
  ASSERT_EQ(result.last_obs.size(), 12u);
  ASSERT_EQ(result.last_phys.size(), static_cast<std::size_t>(kPhysSize));
  EXPECT_GT(result.last_phys[8], 0.29);               // where it fell
  EXPECT_LT(task.batch->phys()[kPhysSize + 8], 0.2);  // the new episode
  EXPECT_LT(result.reward[1], -0.5 - 0.1 * distance + 0.11);
  const auto records = task.batch->TakeRecords();
  ASSERT_EQ(records.size(), 1u);
  EXPECT_EQ(records[0].env, 1);
  EXPECT_EQ(records[0].object, 1);
  EXPECT_EQ(records[0].length, 1);
  EXPECT_NEAR(records[0].mean_distance, distance, 1e-12);
  EXPECT_NEAR(records[0].total_reward, result.reward[1], 1e-7);
  EXPECT_TRUE(task.batch->TakeRecords().empty());
}

TEST(Episode, WithoutAutomaticResetAnEndedEnvironmentRests) {
  TaskOptions options;
  options.episode_length = 2;
  FakeTask task(options, 2);
  task.batch->set_auto_reset(false);
  task.batch->Reset(1, 0, 77);
  task.Step();
  task.batch->Reset(1, 0, 78);
  EXPECT_EQ(task.Step().end[0], EpisodeEnd::kTimeout);
  EXPECT_EQ(task.Step().end[0], EpisodeEnd::kNone);
  EXPECT_EQ(task.sim->steps, (std::vector<int>{2, 3}));
  const auto records = task.batch->TakeRecords();
  ASSERT_EQ(records.size(), 2u);
  EXPECT_EQ(records[1].episode, 78u);
  task.batch->Reset(0, 1, 5);
  task.Step();
  EXPECT_EQ(task.sim->steps[0], 3);
}

TEST(Episode, IsTheSameInEveryEnvironmentBatchAndObjectList) {
  FakeTask small({}, 2, 9), large({}, 5, 9, {"car", "duck", "boat"});
  small.batch->Reset(0, 0, 123);  // duck
  large.batch->Reset(4, 1, 123);
  const auto row = [](const std::vector<float>& rows, int env, int width) {
    return std::vector<float>(rows.begin() + env * width, rows.begin() + (env + 1) * width);
  };
  EXPECT_EQ(row(small.batch->obs(), 0, 12), row(large.batch->obs(), 4, 12));
  EXPECT_EQ(row(small.batch->phys(), 0, kPhysSize), row(large.batch->phys(), 4, kPhysSize));
  EXPECT_EQ(small.batch->goal()[0], large.batch->goal()[4]);
}

TEST(Episode, StartsDifferBetweenEpisodesObjectsAndSeeds) {
  FakeTask task({}, 3), other({}, 3, 2);
  const auto goal = task.batch->goal();
  EXPECT_NE(goal[0], goal[2]);  // the same object, episodes 0 and 2
  EXPECT_NE(goal[0], goal[1]);
  EXPECT_NE(goal[0], other.batch->goal()[0]);
  task.batch->Reset(0, 0, 1);
  EXPECT_NE(goal[0], task.batch->goal()[0]);
}

TEST(Episode, PhysicalDrawsFillTheirRanges) {
  TaskOptions options;
  options.mass_range = {0.03, 0.18};
  options.torsion_range = {0.002, 0.004};
  FakeTask task(options, 400);
  double low = 1, high = 0, torsion = 0;
  for (const EnvPhysics& p : task.sim->physics) {
    low = std::min(low, p.mass);
    high = std::max(high, p.mass);
    EXPECT_EQ(p.gravity, Vector3d(0, 0, 9.81));
    EXPECT_GE(p.torsional_friction, 0.002);
    EXPECT_LE(p.torsional_friction, 0.004);
    torsion += p.torsional_friction / 400;
  }
  EXPECT_NEAR(torsion, 0.003, 1e-4);
  EXPECT_GE(low, 0.03);
  EXPECT_LT(low, 0.033);
  EXPECT_LE(high, 0.18);
  EXPECT_GT(high, 0.177);
}

TEST(Batch, GivesEveryEnvironmentItsObjectInterleavedAndForwardsPushes) {
  FakeTask task({}, 5);
  EXPECT_EQ(task.batch->object(), (std::vector<int>{0, 1, 0, 1, 0}));
  EXPECT_EQ(task.sim->object, task.batch->object());
  task.batch->Push(3, {1, 2, 3});
  ASSERT_EQ(task.sim->pushes.size(), 1u);
  EXPECT_EQ(task.sim->pushes[0].first, 3);
}

TEST(Batch, RefusesGraspsOfAnotherHandOrSize) {
  TaskOptions options;
  options.scale_range = {0.8, 0.9};
  EXPECT_THROW(FakeTask{options}, Error);
  options = {};
  options.mass_range = {2, 1};
  EXPECT_THROW(FakeTask{options}, UsageError);
  options = {};
  options.torsion_range = {-0.001, 0.004};
  EXPECT_THROW(FakeTask{options}, UsageError);
}

TEST(Batch, GravityFactorActsOnTheEpisodesToCome) {
  FakeTask task(TaskOptions{});
  const double whole = task.batch->physics(0).gravity.z();
  ASSERT_GT(whole, 0);
  task.batch->mutable_options().gravity_factor = -0.25;
  EXPECT_EQ(task.batch->physics(0).gravity.z(), whole);
  task.batch->Reset(0, 0, 7);
  EXPECT_DOUBLE_EQ(task.batch->physics(0).gravity.z(), -0.25 * whole);
}

class Wobble {
 public:
  void operator()(int env, EnvState& s) const {
    s.X_WO.q = (Quaterniond(Eigen::AngleAxisd(0.01 + 0.001 * env, Vector3d::UnitY())) * s.X_WO.q)
                   .normalized();
    s.X_WO.p.x() += 1e-3 * std::sin(10 * s.X_WO.p.x() + env);
  }
};

TEST(Batch, ARestoredBatchContinuesBitForBit) {
  TaskOptions options;
  options.episode_length = 17;
  options.tolerance = 1.5;
  options.velocity_tolerance = 100;
  FakeTask one(options), two(options, 4, 1);
  one.sim->script = two.sim->script = Wobble();
  one.batch->mutable_options().gravity_factor = 0.5;  // of the episodes that run when it is saved
  for (int k = 0; k < 30; ++k) one.Step(0.3f, -0.2f);
  one.batch->mutable_options().goal_angle = 1.0;
  one.batch->mutable_options().near_share = 0.25;
  one.batch->mutable_options().gravity_factor = 0.75;  // of those to come
  const auto image = one.batch->Save();
  two.batch->Restore(image);
  EXPECT_EQ(two.batch->Save(), image);
  EXPECT_EQ(two.batch->mutable_options().goal_angle, 1.0);
  EXPECT_EQ(two.batch->mutable_options().near_share, 0.25);
  for (int k = 0; k < 40; ++k) {
    const StepResult a = one.Step(-0.1f, 0.4f), b = two.Step(-0.1f, 0.4f);
    EXPECT_EQ(a.reward, b.reward);
    EXPECT_EQ(a.success, b.success);
    EXPECT_EQ(a.last_phys, b.last_phys);
    EXPECT_EQ(one.batch->obs(), two.batch->obs());
    EXPECT_EQ(one.batch->phys(), two.batch->phys());
    for (int env = 0; env < 4; ++env)
      EXPECT_EQ(one.batch->physics(env).gravity, two.batch->physics(env).gravity);
  }
  EXPECT_EQ(one.batch->Save(), two.batch->Save());
  EXPECT_GT(one.batch->TakeRecords().size(), 4u);
}

TEST(Batch, RestoreRefusesAnImageOfAnotherBatchOrACutOne) {
  FakeTask four({}, 4), five({}, 5);
  auto image = five.batch->Save();
  EXPECT_THROW(four.batch->Restore(image), Error);
  image.pop_back();
  EXPECT_THROW(five.batch->Restore(image), Error);
}

}  // namespace
}  // namespace dexremoe
