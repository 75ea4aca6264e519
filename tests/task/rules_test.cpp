// Goals and the arithmetic of success and reward.
#include "task/rules.h"

#include <gtest/gtest.h>

#include <numbers>

#include "task/goal.h"
#include "task/rotation.h"

namespace dexremoe {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(Rotation, VectorAndDistanceAgreeWithTheAngleNearZeroAndNearPi) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, -2, 3).normalized();
  for (const double angle : {0.0, 1e-9, 1e-4, 0.4, 2.0, 3.1, kPi - 1e-7}) {
    const Eigen::Quaterniond q(Eigen::AngleAxisd(angle, axis));
    EXPECT_NEAR(RotationDistance(q, Eigen::Quaterniond::Identity()), angle, 1e-12);
    EXPECT_LT((RotationVector(q) - angle * axis).norm(), 1e-12);
    EXPECT_LT((RotationVector(Eigen::Quaterniond(-q.coeffs())) - angle * axis).norm(), 1e-12);
  }
}

TEST(Goal, HaarGoalsHaveTheDistancesOfUniformRotations) {
  // Mean pi/2 + 2/pi = 2.207 rad; P(distance <= a) = (a - sin a) / pi = 0.337 % at 0.4.
  const Eigen::Quaterniond from(Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitX()));
  Rng rng(3, Stream::kTest);
  const int n = 200000;
  double sum = 0;
  int near = 0;
  for (int i = 0; i < n; ++i) {
    const double distance = RotationDistance(DrawGoal(rng, from, 0.4, 3.1416), from);
    sum += distance;
    near += distance <= 0.4;
  }
  EXPECT_NEAR(sum / n, kPi / 2 + 2 / kPi, 4 * 0.65 / std::sqrt(n));
  const double p = (0.4 - std::sin(0.4)) / kPi;
  EXPECT_NEAR(p, 0.00337, 1e-5);
  EXPECT_NEAR(near, n * p, 4 * std::sqrt(n * p));
}

TEST(Goal, RestrictedGoalsFollowTheHaarAngleDensityWithUniformAxes) {
  const Eigen::Quaterniond from(Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, 1, 0).normalized()));
  Rng rng(4, Stream::kTest);
  const int n = 20000;
  const double low = 0.4, high = 1.2, middle = 0.9;
  const auto mass = [](double a) { return a - std::sin(a); };
  int below = 0;
  Eigen::Vector3d axes = Eigen::Vector3d::Zero();
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d v = RotationVector(DrawGoal(rng, from, low, high) * from.conjugate());
    EXPECT_GE(v.norm(), low - 1e-9);
    EXPECT_LE(v.norm(), high + 1e-9);
    below += v.norm() < middle;
    axes += v.normalized();
  }
  const double p = (mass(middle) - mass(low)) / (mass(high) - mass(low));
  EXPECT_NEAR(below, n * p, 4 * std::sqrt(n * p * (1 - p)));
  EXPECT_LT((axes / n).norm(), 4 / std::sqrt(n));
}

TEST(Goal, AngleBelowTheToleranceGivesThatAngle) {
  Rng rng(5, Stream::kTest);
  const Eigen::Quaterniond from = Eigen::Quaterniond::Identity();
  EXPECT_NEAR(RotationDistance(DrawGoal(rng, from, 0.4, 0.2), from), 0.2, 1e-9);
}

TEST(Reward, EqualsTheSumByHand) {
  TaskOptions options;
  options.c_progress = 7;
  options.c_fall = -100;
  StepFacts facts;
  facts.angle = 0.3;
  facts.previous_angle = 0.5;
  facts.distance = 0.02;
  facts.excess_joint_speed = 3;
  facts.squared_action = 5;
  const double plain = -10 * 0.02 + 1 / 0.4 - 0.05 * 3 - 0.0002 * 5 + 7 * 0.2;
  EXPECT_NEAR(Reward(options, facts), 0.01 * plain, 1e-15);
  facts.success = true;
  EXPECT_NEAR(Reward(options, facts), 0.01 * (plain + 800), 1e-14);
  facts.fall = true;
  EXPECT_NEAR(Reward(options, facts), 0.01 * (plain + 700), 1e-14);
}

TEST(Reward, TheLiteralSignOfThePaperStaysSelectable) {
  TaskOptions options;
  options.c_rot = -1;
  StepFacts near, far;
  near.angle = near.previous_angle = 0.1;
  far.angle = far.previous_angle = 2;
  EXPECT_LT(Reward(options, near), Reward(options, far));
}

TEST(MeetsGoal, NeedsEveryCondition) {
  const TaskOptions options;
  StepFacts good;
  good.angle = 0.399;
  good.max_joint_speed = 9.99;
  good.speed = 0.0399;
  good.spin = 0.499;
  EXPECT_TRUE(MeetsGoal(options, good));
  for (double StepFacts::*field :
       {&StepFacts::angle, &StepFacts::max_joint_speed, &StepFacts::speed, &StepFacts::spin}) {
    StepFacts bad = good;
    bad.*field *= 1.02;
    EXPECT_FALSE(MeetsGoal(options, bad));
  }
}

TEST(MeetsGoal, VelocityToleranceWidensSpeedAndSpinOnly) {
  TaskOptions options;
  options.velocity_tolerance = 5;
  StepFacts facts;
  facts.speed = 0.19;
  facts.spin = 2.4;
  EXPECT_TRUE(MeetsGoal(options, facts));
  facts.max_joint_speed = 11;
  EXPECT_FALSE(MeetsGoal(options, facts));
}

}  // namespace
}  // namespace dexremoe
