// One joint: the implicit servo with reflected inertia, and its limits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "scenes.h"

namespace dexremoe {
namespace {

using scenes::Rig;

constexpr double kInertia = 1e-4;  // of the link; kg m^2

class Servo : public scenes::OnEveryEngine {
 protected:
  Rig MakeRig(const HandModel& hand, int substeps) const {
    return Rig(Options(substeps), hand, {scenes::Cube()});
  }
};
DEX_RUN_ON_EVERY_ENGINE(Servo);

EnvState AtAngle(double q, double qd = 0) {
  EnvState state = scenes::StateAt(1, {0, 0, 5});
  state.q = {q};
  state.qd = {qd};
  return state;
}

// (A + I) (qd' - qd) / h = kp (target - q - h qd') - kd qd', q' = q + h qd'.
TEST_P(Servo, StepResponseEqualsTheImplicitEulerRecursion) {
  for (const int substeps : {1, 2, 4}) {
    const HandModel hand = scenes::Rotor(kInertia);
    Rig rig = MakeRig(hand, substeps);
    rig->SetState(0, AtAngle(0.1, -0.5));
    const double target = 0.4, h = TimeStep(Options(substeps)), inertia = hand.armature + kInertia;
    double q = 0.1, qd = -0.5;
    for (int step = 0; step < 30; ++step) {
      rig->Step(std::vector<double>{target});
      for (int i = 0; i < std::lround(1 / (60 * h)); ++i) {
        qd = (inertia / h * qd + hand.kp * (target - q)) / (inertia / h + h * hand.kp + hand.kd);
        q += h * qd;
      }
      EXPECT_NEAR(rig->GetState(0).q[0], q, GetParam().servo_angle)
          << "substeps " << substeps << " step " << step;
      EXPECT_NEAR(rig->GetState(0).qd[0], qd, GetParam().servo_speed);
    }
    EXPECT_NEAR(q, target, 0.01);
  }
}

TEST_P(Servo, GainFactorsScaleTheGains) {
  const HandModel hand = scenes::Rotor(kInertia);
  SimOptions options = Options(1);
  options.inner_steps = 1;
  Rig rig(options, hand, {scenes::Cube()});
  EnvPhysics physics;
  physics.kp_factor = 0.5;
  physics.kd_factor = 2;
  rig->SetObject(0, 0, physics);
  rig->SetState(0, AtAngle(0));
  rig->Step(std::vector<double>{0.3});
  const double h = 1.0 / 60, kp = 0.5 * hand.kp, kd = 2 * hand.kd;
  EXPECT_NEAR(rig->GetState(0).qd[0], kp * 0.3 / ((hand.armature + kInertia) / h + h * kp + kd),
              1e-4);
}

TEST_P(Servo, ALimitedTorqueAcceleratesRotorAndLinkUniformly) {
  HandModel hand = scenes::Rotor(kInertia);
  hand.joints[0].torque_limit = 0.05;
  Rig rig = MakeRig(hand, 2);
  rig->SetState(0, AtAngle(0));
  const double acceleration = 0.05 / (hand.armature + kInertia);
  for (int step = 1; step <= 4; ++step) {
    rig->Step(std::vector<double>{1.9});
    EXPECT_NEAR(rig->GetState(0).qd[0], acceleration * step / 60, 1e-3) << "step " << step;
  }
}

// A horizontal arm with a load of 0.4905 N m: a little more torque lifts it, a little less lowers
// it.
TEST_P(Servo, TheTorqueLimitIsWhatALoadedJointGives) {
  for (const double limit : {0.47, 0.51}) {
    HandModel hand = scenes::Rotor(kInertia);
    hand.links[1].mass = 0.5;
    hand.links[1].com = {0.1, 0, 0};
    hand.joints[0].torque_limit = limit;
    Rig rig = MakeRig(hand, 2);
    rig->SetState(0, AtAngle(0));  // gravity along +z turns the arm to negative angles about +y
    for (int step = 0; step < 10; ++step) rig->Step(std::vector<double>{1.5});
    const double torque = limit - 0.5 * 9.81 * 0.1, inertia = hand.armature + kInertia + 0.5 * 0.01;
    const double t = 10.0 / 60;
    EXPECT_NEAR(rig->GetState(0).q[0], 0.5 * torque / inertia * t * t, 0.01) << limit;
  }
}

TEST_P(Servo, TheSpeedLimitIsReachedAndHolds) {
  HandModel hand = scenes::Rotor(kInertia);
  hand.joints[0].torque_limit = 0.5;
  hand.joints[0].speed_limit = 6.2;
  Rig rig = MakeRig(hand, 2);
  rig->SetState(0, AtAngle(-1.9));
  double fastest = 0;
  for (int step = 0; step < 30; ++step) {
    rig->Step(std::vector<double>{1.9});
    fastest = std::max(fastest, std::abs(rig->GetState(0).qd[0]));
  }
  EXPECT_LE(fastest, 6.2 + 1e-6);
  EXPECT_GT(fastest, 5.9);
}

TEST_P(Servo, JointLimitsHoldAgainstALoad) {
  HandModel hand = scenes::Rotor(kInertia);
  hand.links[1].mass = 0.5;
  hand.links[1].com = {0.1, 0, 0};
  hand.joints[0].lower = -0.5;
  hand.joints[0].torque_limit = 0.1;  // the load wins and falls onto the stop
  Rig rig = MakeRig(hand, GetParam().substeps.back());
  rig->SetState(0, AtAngle(0.2));
  double deepest = 0, fastest = 0;
  for (int step = 0; step < 120; ++step) {
    rig->Step(std::vector<double>{1.0});
    fastest = std::max(fastest, std::abs(rig->GetState(0).qd[0]));
    deepest = std::max(deepest, -0.5 - rig->GetState(0).q[0]);
  }
  EXPECT_LT(deepest, fastest * GetParam().stop_time);
  EXPECT_NEAR(rig->GetState(0).q[0], -0.5, 1e-3);
}

TEST_P(Servo, TargetsBeyondTheLimitsCountAsTheLimits) {
  const HandModel hand = scenes::Rotor(kInertia);
  Rig rig = MakeRig(hand, 2);
  rig->SetState(0, AtAngle(1.5));
  for (int step = 0; step < 120; ++step) rig->Step(std::vector<double>{50.0});
  EXPECT_NEAR(rig->GetState(0).q[0], 2, 1e-3);
}

TEST_P(Servo, SetStateGivesLinksTheVelocitiesOfTheJoints) {
  HandModel hand = LoadHand(HandOptions());
  hand.kp = 1e-6;
  hand.kd = 0;
  Rig rig = MakeRig(hand, 1);
  EnvState state = scenes::StateAt(hand.num_joints(), {0, 0, 5});
  for (int j = 0; j < hand.num_joints(); ++j) {
    state.q[j] = 0.3 + 0.02 * j;
    state.qd[j] = 0.5 - 0.1 * j;
  }
  rig->SetState(0, state);
  const EnvState set = rig->GetState(0);
  for (int j = 0; j < hand.num_joints(); ++j) {
    EXPECT_NEAR(set.q[j], state.q[j], GetParam().round_off) << hand.joints[j].name;
    EXPECT_NEAR(set.qd[j], state.qd[j], GetParam().round_off) << hand.joints[j].name;
  }
}

}  // namespace
}  // namespace dexremoe
