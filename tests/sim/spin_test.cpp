// Torsional friction: a block pinched by two opposite fingertips, and spun about the line between
// them.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "grasp_scene.h"

namespace dexremoe {
namespace {

using Eigen::Vector3d;

constexpr double kFinger = 0.1;           // m, from joint to tip
constexpr double kServo = 3;              // N m/rad
constexpr double kTorsion = 0.004;        // m
const Vector3d kBlock(0.08, 0.08, 0.04);  // m

// Adds a finger along +x whose tip, a ball, rests at (0, 0, z) and turns about y.
void AddFinger(double z, HandModel& hand) {
  HandModel one = scenes::Rotor();
  const int link = static_cast<int>(hand.links.size()), joint = link - 1;
  one.links[1].name = "finger" + std::to_string(link);
  one.links[1].chain = joint;
  one.joints[0].name = "joint" + std::to_string(link);
  one.joints[0].child = link;
  one.joints[0].X_PJ.p = {-kFinger, 0, z};
  Collider tip;
  tip.name = "tip" + std::to_string(link);
  tip.link = link;
  tip.shape = ColliderShape::kSphere;
  tip.X_LC.p = {kFinger, 0, 0};
  tip.radius = 0.01;
  tip.fingertip = true;
  hand.links.push_back(one.links[1]);
  hand.joints.push_back(one.joints[0]);
  hand.chains.push_back({joint});
  hand.tip_frames.push_back(Pose());
  hand.colliders.push_back(tip);
}

HandModel Pincers() {
  HandModel hand = scenes::PalmOnly();
  hand.colliders.clear();
  hand.armature = 0.0015;
  hand.kp = kServo;
  for (const double side : {1.0, -1.0}) AddFinger(side * (kBlock.z() / 2 + 0.01), hand);
  return hand;
}

// The block between the tips, which press on it with about a newton each.
class Pinch {
 public:
  Pinch(const SimOptions& options, const EnvPhysics& physics)
      : object_(scenes::Block(kBlock)), physics_(physics), rig_(options, Pincers(), {object_}) {
    rig_->SetObject(0, 0, physics);
    rig_->SetState(0, scenes::StateAt(2, Vector3d::Zero()));
    rig_->SetHeld(0, true);
    Step(30);
    rig_->SetHeld(0, false);
  }

  void Step(int steps) {
    for (int i = 0; i < steps; ++i) rig_->Step(kTargets);
  }
  void Spin(double speed) {
    EnvState state = rig_->GetState(0);
    state.w = {0, 0, speed};
    rig_->SetState(0, state);
  }
  double Speed() { return rig_->GetState(0).w.z(); }
  double Angle() {
    const Eigen::Quaterniond q = rig_->GetState(0).X_WO.q;
    return 2 * std::atan2(q.z(), q.w());
  }
  // Of both tips together, from the servos' torques; N.
  double NormalForce() {
    const EnvState state = rig_->GetState(0);
    double sum = 0;
    for (int j = 0; j < 2; ++j) sum += kServo * std::abs(kTargets[j] - state.q[j]) / kFinger;
    return sum;
  }
  // About the pinch axis through the centre of mass; kg m^2.
  double Inertia() const { return physics_.mass * object_.unit_inertia(2, 2); }

 private:
  const std::vector<double> kTargets = {0.035, -0.035};  // rad

  SimObject object_;
  EnvPhysics physics_;
  scenes::Rig rig_;
};

EnvPhysics Weightless(double torsion) {
  EnvPhysics physics;
  physics.mass = 0.5;
  physics.gravity.setZero();
  physics.torsional_friction = torsion;
  return physics;
}

// Gravity across the pinch axis pulls at a centre of mass beside it: its force is `slide` of what
// friction carries, its moment `moment` of what torsional friction carries, each alone.
double AngleUnderLoad(const SimOptions& options, double slide, double moment) {
  EnvPhysics physics;
  physics.mass = 0.1;
  physics.torsional_friction = kTorsion;
  const double press = Pinch(options, Weightless(kTorsion)).NormalForce();
  physics.gravity = {slide * physics.friction * press / physics.mass, 0, 0};
  physics.com = {0, -moment * kTorsion / (slide * physics.friction), 0};
  Pinch pinch(options, physics);
  pinch.Step(60);
  return std::abs(pinch.Angle());
}

class SoftFinger : public scenes::OnEveryEngine {};
DEX_RUN_ON_EVERY_ENGINE(SoftFinger);

TEST_P(SoftFinger, APinchedObjectThatSpinsSlowsAtTheRateOfTheMomentAndStops) {
  for (const int substeps : GetParam().substeps) {
    Pinch pinch(Options(substeps), Weightless(kTorsion));
    pinch.Spin(6);
    pinch.Step(3);
    const double before = pinch.Speed();
    pinch.Step(12);
    const double rate = (before - pinch.Speed()) * 5;
    const double expected = kTorsion * pinch.NormalForce() / pinch.Inertia();
    std::printf("substeps %d: slows by %.3f rad/s^2, expected %.3f\n", substeps, rate, expected);
    EXPECT_NEAR(rate, expected, 0.03 * expected);
    pinch.Step(45);
    EXPECT_NEAR(pinch.Speed(), 0, 0.02);
  }
}

TEST_P(SoftFinger, BetweenPointContactsAPinchedObjectSpinsOn) {
  Pinch pinch(Options(GetParam().substeps.back()), Weightless(0));
  pinch.Spin(6);
  pinch.Step(60);
  EXPECT_NEAR(pinch.Speed(), 6, 0.1);
}

// A sliding force of 0.6 of its most leaves 0.8 of the moment's.
TEST_P(SoftFinger, AMomentWithinTheEllipsoidHoldsAndOneBeyondItTurns) {
  struct Load {
    double slide, within, beyond;
  };
  const SimOptions options = Options(GetParam().substeps.back());
  for (const Load& load : {Load{0.1, 0.8, 1.25}, Load{0.6, 0.5, 0.95}}) {
    const double within = AngleUnderLoad(options, load.slide, load.within);
    const double beyond = AngleUnderLoad(options, load.slide, load.beyond);
    std::printf("sliding force %.1f of the most: turns by %.4f rad within, %.4f rad beyond\n",
                load.slide, within, beyond);
    EXPECT_LT(within, GetParam().spin_creep);
    EXPECT_GT(beyond, 0.3);
  }
}

TEST_P(SoftFinger, GraspsHoldTheCubeBelowTheSuccessThresholds) {
  constexpr int kTries = 24;
  EnvPhysics physics;
  physics.torsional_friction = kTorsion;
  scenes::GraspScene scene(Options(GetParam().substeps.back()), kTries, 1, physics);
  scene.Close(50);
  scene.Release();
  for (int step = 0; step < 60; ++step) scene.rig->Step(scene.targets);
  int quiet = 0;
  for (int env = 0; env < kTries; ++env) {
    const EnvState state = scene.rig->GetState(env);
    quiet += scene.Holds(env) && state.v.norm() < 0.04 && state.w.norm() < 0.5;
  }
  std::printf("%d of %d grasps hold quietly for a second\n", quiet, kTries);
  EXPECT_GE(quiet, 20);
}

}  // namespace
}  // namespace dexremoe
