// What is special about the lanes engine: instruction sets, blocks of different objects, limits.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "base/error.h"
#include "grasp_scene.h"
#include "sim/lanes/lanes_sim.h"

namespace dexremoe {
namespace {

using Eigen::Vector3d;
using scenes::GraspScene;
using scenes::Rig;

SimOptions Lanes(const std::string& instructions = "auto") {
  SimOptions options;
  options.engine = "lanes";
  options.instructions = instructions;
  return options;
}

template <typename Action>
std::string MessageOf(Action action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Lanes, InstructionSetsAgreeWhileFingersCloseAndHold) {
  const std::vector<std::string> sets = LaneInstructions();
  ASSERT_EQ(sets.back(), "portable");
  GraspScene reference(Lanes("portable"), 20, 1);
  reference.Close(50);
  reference.Release();
  for (int step = 0; step < 10; ++step) reference.rig->Step(reference.targets);
  for (const std::string& set : sets) {
    GraspScene scene(Lanes(set), 20, 1);
    scene.Close(50);
    scene.Release();
    for (int step = 0; step < 10; ++step) scene.rig->Step(scene.targets);
    double apart = 0;
    int same = 0;
    for (int env = 0; env < 20; ++env) {
      const double d =
          (scene.rig->GetState(env).X_WO.p - reference.rig->GetState(env).X_WO.p).norm();
      apart = std::max(apart, d);
      same += d < 1e-3;
    }
    std::printf("%s: %d of 20 objects within 1 mm of portable's after 1 s; farthest %.3g mm\n",
                set.c_str(), same, 1e3 * apart);
    EXPECT_GE(same, 16) << set;  // contacts magnify the last bits where a grasp slips
  }
}

TEST(Lanes, AnInstructionSetThatIsNotThereIsRefused) {
  ThreadPool pool(1);
  const auto make = [&] {
    MakeBatchSim(Lanes("mmx"), scenes::PalmOnly(), {scenes::Cube()}, 1, pool);
  };
  EXPECT_NE(MessageOf(make).find("sim.instructions: this processor has no mmx"), std::string::npos);
}

// A slab that falls onto the palm at its own angle; environment `env` of `rig`.
void Drop(Rig& rig, int env, int object, int variant) {
  EnvPhysics physics;
  physics.gravity = {0, 0, -9.81};
  physics.friction = 0.3 + 0.1 * variant;
  physics.com = {0.001 * variant, 0, 0};
  physics.scale = 1 - 0.05 * variant;
  rig->SetObject(env, object, physics);
  EnvState state = scenes::StateAt(0, {0, 0, 0.06});
  state.X_WO.q = Eigen::AngleAxisd(0.3 * variant, Vector3d(1, 0.5, 0.2).normalized());
  rig->SetState(env, state);
}

const std::vector<SimObject>& Objects() {
  static const std::vector<SimObject> objects = {scenes::Cube(), scenes::Block({0.03, 0.05, 0.08}),
                                                 scenes::Block({0.09, 0.02, 0.04})};
  return objects;
}

TEST(Lanes, AnEnvironmentMovesTheSameWhateverObjectsItsNeighboursHold) {
  Rig crowd(Lanes(), scenes::PalmOnly(), Objects(), 40, 2);
  for (int env = 0; env < 40; ++env) Drop(crowd, env, env % 3, env % 5);
  for (int step = 0; step < 30; ++step) crowd->Step({});
  for (int env : {0, 1, 2, 22, 39}) {
    Rig alone(Lanes(), scenes::PalmOnly(), Objects(), 1, 1);
    Drop(alone, 0, env % 3, env % 5);
    for (int step = 0; step < 30; ++step) alone->Step({});
    EXPECT_EQ(alone->Save(0), crowd->Save(env)) << env;
  }
}

// Vectors of lanes without soft fingers skip their rows; with them, point contacts stay what they
// are.
TEST(Lanes, PointContactsAreTheSameBitForBitBesideSoftFingers) {
  GraspScene points(Lanes(), 20, 1), mixed(Lanes(), 20, 1);
  mixed.physics.torsional_friction = 0.004;
  for (int env = 1; env < 20; env += 2) mixed.Start(env, env, 7);
  for (GraspScene* scene : {&points, &mixed}) {
    scene->Close(45);
    scene->Release();
    for (int step = 0; step < 20; ++step) scene->StepRandomly(step);
  }
  for (int env = 0; env < 20; ++env)
    EXPECT_EQ(mixed.rig->Save(env) == points.rig->Save(env), env % 2 == 0) << env;
}

TEST(Lanes, AnEnvironmentKeepsItsStateWhenAnotherGetsANewObject) {
  Rig still(Lanes(), scenes::PalmOnly(), Objects(), 20, 1);
  Rig changed(Lanes(), scenes::PalmOnly(), Objects(), 20, 1);
  for (Rig* rig : {&still, &changed}) {
    for (int env = 0; env < 20; ++env) Drop(*rig, env, env % 2, env % 4);
    for (int step = 0; step < 10; ++step) (*rig)->Step({});
  }
  Drop(changed, 3, 2, 1);
  for (Rig* rig : {&still, &changed})
    for (int step = 0; step < 10; ++step) (*rig)->Step({});
  for (int env = 0; env < 20; ++env)
    EXPECT_EQ(still->Save(env) == changed->Save(env), env != 3) << env;
}

// Two plates of the base, of which only the second one listed is in the finger's way.
TEST(Lanes, AFingertipStopsAtEveryColliderOfThePalm) {
  HandModel hand = scenes::PalmOnly();
  Collider near = hand.colliders[0];
  hand.colliders[0].X_LC.p = {0, 0, -0.5};
  near.X_LC.p = {0, 0, -0.07};  // its face is z = -0.05
  hand.colliders.push_back(near);
  Link upper, tip;  // a finger of two links along x that turns down about y
  upper.name = "upper";
  upper.parent = 0;
  upper.chain = tip.chain = 0;
  tip.name = "tip";
  tip.parent = 1;
  upper.mass = tip.mass = 0.03;
  upper.inertia = tip.inertia = 1e-5 * Eigen::Matrix3d::Identity();
  hand.links.insert(hand.links.end(), {upper, tip});
  Joint joint = scenes::Rotor().joints[0];
  joint.torque_limit = 0.2;
  Joint second = joint;
  second.name = "second";
  second.parent = 1;
  second.child = 2;
  second.X_PJ.p = {0.05, 0, 0};
  hand.joints = {joint, second};
  hand.chains = {{0, 1}};
  hand.tip_frames = {Pose()};
  hand.armature = 0.0015;
  Collider ball;
  ball.name = "ball";
  ball.shape = ColliderShape::kSphere;
  ball.link = 2;
  ball.X_LC.p = {0.04, 0, 0};
  ball.radius = 0.01;
  ball.fingertip = true;
  hand.colliders.push_back(ball);
  Rig rig(Lanes(), hand, {scenes::Cube()});
  rig->SetState(0, scenes::StateAt(2, {0, 0, 3}));
  for (int step = 0; step < 60; ++step) rig->Step(std::vector<double>{1.2, 0.0});
  const EnvState state = rig->GetState(0);
  const double height = -0.05 * std::sin(state.q[0]) - 0.04 * std::sin(state.q[0] + state.q[1]);
  EXPECT_NEAR(height - ball.radius, -0.05, 2e-3);
}

TEST(Lanes, AnEnvironmentTakesLessThanOneAndAHalfKilobytes) {
  GraspScene scene(Lanes(), 1, 1);
  const LanesFootprint footprint = FootprintOf(*scene.rig.sim);
  EXPECT_LT(footprint.bytes_per_env, 1500u);
  EXPECT_LT(footprint.bytes_per_object, 70000u);
}

TEST(Lanes, SharesOfTheProfileAddUpToOne) {
  GraspScene scene(Lanes(), 32, 1);
  StartProfile(*scene.rig.sim);
  scene.Close(20);
  const LanesProfile profile = StopProfile(*scene.rig.sim);
  double sum = 0;
  for (const double share : profile.shares) sum += share;
  EXPECT_NEAR(sum, 1, 1e-9);
  EXPECT_EQ(profile.phases.size(), profile.shares.size());
}

TEST(Lanes, OtherEnginesHaveNoFootprint) {
  Rig rig(SimOptions(), scenes::PalmOnly(), {scenes::Cube()});
  EXPECT_THROW(FootprintOf(*rig.sim), Error);
}

TEST(Lanes, AHandWithTooManyJointsIsRefused) {
  HandModel hand = scenes::Rotor();
  hand.source = "many.urdf";
  while (hand.chains.size() < 6) hand.chains.push_back({});
  ThreadPool pool(1);
  const auto make = [&] { MakeBatchSim(Lanes(), hand, {scenes::Cube()}, 1, pool); };
  EXPECT_EQ(MessageOf(make), "many.urdf: fingers: the lanes engine takes at most 5, found 6");
}

// More sweeps change a converged contact little: the default is near the limit of many.
TEST(Lanes, AHeldCubeSagsLittleMoreThanWithManySweeps) {
  SimOptions many = Lanes();
  many.substeps = 4;
  many.iterations = 50;
  double sag[2] = {0, 0};
  int held = 0;
  GraspScene coarse(Lanes(), 40, 1), fine(many, 40, 1);
  for (GraspScene* scene : {&coarse, &fine}) {
    scene->Close(50);
    scene->Release();
    for (int step = 0; step < 60; ++step) scene->rig->Step(scene->targets);
  }
  for (int env = 0; env < 40; ++env) {
    if (!coarse.Holds(env) || !fine.Holds(env)) continue;
    ++held;
    sag[0] += coarse.rig->GetState(env).X_WO.p.z() - scenes::kGraspCenter.z();
    sag[1] += fine.rig->GetState(env).X_WO.p.z() - scenes::kGraspCenter.z();
  }
  ASSERT_GE(held, 30);
  std::printf("mean sag after 1 s: %.2f mm, with many sweeps %.2f mm\n", 1e3 * sag[0] / held,
              1e3 * sag[1] / held);
  EXPECT_NEAR(sag[0] / held, sag[1] / held, 1e-3);
}

}  // namespace
}  // namespace dexremoe
