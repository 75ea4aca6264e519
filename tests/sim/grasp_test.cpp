// The GX11 holding a 55 mm cube, and the batch properties on that scene.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <string>

#include "base/error.h"
#include "grasp_scene.h"

namespace dexremoe {
namespace {

using Eigen::Vector3d;
using scenes::GraspScene;

double CpuSeconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Friction of every kind.
EnvPhysics SoftFingers() {
  EnvPhysics physics;
  physics.torsional_friction = 0.004;
  return physics;
}

class Grasp : public scenes::OnEveryEngine {};
DEX_RUN_ON_EVERY_ENGINE(Grasp);
class Batch : public scenes::OnEveryEngine {};
DEX_RUN_ON_EVERY_ENGINE(Batch);

// Measured over 200 tries: 184, 184 and 185 hold in ODE at 1, 2 and 4 substeps.
TEST_P(Grasp, MostClosedGraspsHoldTheCubeForASecond) {
  for (const int substeps : GetParam().substeps) {
    const int tries = 60;
    GraspScene scene(Options(substeps), tries, 1);
    scene.Close(50);
    scene.Release();
    const double start = CpuSeconds();
    for (int step = 0; step < 60; ++step) scene.rig->Step(scene.targets);
    const double seconds = CpuSeconds() - start;
    int held = 0, quiet = 0;
    for (int env = 0; env < tries; ++env) {
      const EnvState state = scene.rig->GetState(env);
      if (!scene.Holds(env)) continue;
      ++held;
      quiet += state.v.norm() < 0.04 && state.w.norm() < 0.5;
      EXPECT_LT(scene.rig->state().max_penetration[env], 1e-3);
    }
    std::printf("substeps %d: %d of %d held 1 s, %d of them quiet; %.0f substeps/s/core\n",
                substeps, held, tries, quiet, 60.0 * substeps * tries / seconds);
    EXPECT_GE(held, 45);
    EXPECT_GE(quiet, held * 9 / 10);
  }
}

TEST_P(Batch, ResultsAreEqualBitForBitForAnyNumberOfWorkers) {
  std::vector<double> expected;
  for (const int workers : {1, 2, 4}) {
    GraspScene scene(Options(), 9, workers, SoftFingers());
    scene.Close(40);
    scene.Release();
    for (int step = 0; step < 20; ++step) scene.StepRandomly(step);
    const SimState& state = scene.rig->state();
    std::vector<double> found = state.joint_position;
    for (const auto* more : {&state.joint_velocity, &state.object_position, &state.object_rotation,
                             &state.object_velocity, &state.object_spin})
      found.insert(found.end(), more->begin(), more->end());
    if (workers == 1) expected = found;
    EXPECT_EQ(found, expected) << workers << " workers";
  }
}

TEST_P(Batch, AnEnvironmentDoesNotDependOnItsIndexOrItsNeighbours) {
  GraspScene alone(Options(), 1, 1, SoftFingers()), crowd(Options(), 70, 2, SoftFingers());
  crowd.Start(69, 0, 7);  // the very start of alone's environment 0, in a shared chunk
  for (GraspScene* scene : {&alone, &crowd}) {
    scene->Close(45);
    scene->Release();
    for (int step = 0; step < 10; ++step) scene->rig->Step(scene->targets);
  }
  EXPECT_EQ(crowd.rig->Save(69), alone.rig->Save(0));
}

TEST_P(Batch, ARestoredEnvironmentContinuesBitForBit) {
  GraspScene scene(Options(), 2, 1, SoftFingers()), other(Options(), 2, 1);
  scene.Close(45);
  scene.Release();
  for (int step = 0; step < 5; ++step) scene.StepRandomly(step);
  scene.rig->PushObject(0, {0.1, 0, 0});  // a push that is still to come is part of the state
  for (int env = 0; env < 2; ++env) other.rig->Restore(env, scene.rig->Save(env));
  other.targets = scene.targets;
  EXPECT_EQ(other.rig->state().object_position, scene.rig->state().object_position);
  EXPECT_EQ(other.rig->state().tip_contact, scene.rig->state().tip_contact);
  for (int step = 5; step < 40; ++step) {
    scene.StepRandomly(step);
    other.StepRandomly(step);
    for (int env = 0; env < 2; ++env)
      ASSERT_EQ(other.rig->Save(env), scene.rig->Save(env)) << "step " << step;
  }
}

TEST_P(Batch, ASavedStateOfTheWrongSizeIsRefused) {
  GraspScene scene(Options(), 1, 1);
  std::vector<std::uint8_t> bytes = scene.rig->Save(0);
  bytes.pop_back();
  EXPECT_THROW(scene.rig->Restore(0, bytes), Error);
}

TEST_P(Batch, AHeldObjectStaysWhereItIsAndAReleasedOneFalls) {
  GraspScene scene(Options(), 1, 1);
  const Vector3d start = scene.rig->GetState(0).X_WO.p;
  scene.Close(50);
  EXPECT_GT(scene.rig->state().contact_count[0], 0);
  EXPECT_EQ(scene.rig->GetState(0).X_WO.p, start);
  EXPECT_EQ(scene.rig->GetState(0).v, Vector3d::Zero());
  scene.Start(0, 0, 7);  // open again
  scene.Release();
  for (int step = 0; step < 30; ++step) scene.rig->Step(scene.targets);
  EXPECT_GT(scene.rig->GetState(0).X_WO.p.z(), start.z() + 0.5);
}

TEST_P(Batch, InactiveEnvironmentsDoNotMove) {
  GraspScene scene(Options(), 2, 1);
  const std::vector<std::uint8_t> before = scene.rig->Save(1);
  scene.rig->Step(scene.targets, std::vector<std::uint8_t>{1, 0});
  EXPECT_EQ(scene.rig->Save(1), before);
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

TEST_P(Batch, NonFiniteNumbersAreNamed) {
  GraspScene scene(Options(), 3, 1);
  scene.Release();
  scene.rig->Step(scene.targets);
  scene.rig->PushObject(1, {1e308, 1e308, 0});
  const std::string message = MessageOf([&] { scene.rig->Step(scene.targets); });
  EXPECT_EQ(message.substr(0, 30), "environment 1: step 1: object_") << message;
  // The environment is usable again once it is set anew.
  scene.Start(1, 1, 7);
  scene.Close(5);
  EXPECT_EQ(MessageOf([&] { scene.rig->Step(scene.targets); }), "no error");
  GraspScene second(Options(), 3, 1);
  second.targets[2 * second.hand.num_joints()] = NAN;
  EXPECT_EQ(MessageOf([&] { second.rig->Step(second.targets); }),
            "environment 2: step 0: target: expected finite angles");
}

TEST(Engine, IsChosenByName) {
  ThreadPool pool(1);
  SimOptions options;
  options.engine = "bullet";
  const auto make = [&] { MakeBatchSim(options, scenes::PalmOnly(), {scenes::Cube()}, 1, pool); };
  EXPECT_EQ(MessageOf(make), "sim.engine: expected ode, lanes or mujoco, found 'bullet'");
}

}  // namespace
}  // namespace dexremoe
