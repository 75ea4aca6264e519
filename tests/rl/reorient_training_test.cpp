// Training on the real task: a cube between the fingers of the GX11, in the ODE engine.
#include <gtest/gtest.h>

#include "../sim/scenes.h"
#include "fixture.h"
#include "io/atomic_file.h"
#include "rl/reorient_env.h"

namespace dexremoe {
namespace {

// The start pose holds a 30 mm ball; whether the cube stays or drops does not matter here, as both
// ends of an episode must survive a resume.
TaskObject CubeObject() {
  TaskObject object;
  object.name = "cube";
  object.sim = scenes::Cube(0.03);
  object.mass = 0.08;
  object.feature.assign(kShapeFeatureSize, 0.5f);
  Grasp grasp;
  grasp.q = {1.658, 0.258, 0.177, 0.942, 0.100, 0.514, 0.185, 1.554, 0.447, -0.450, 0.153};
  grasp.target = grasp.q;
  grasp.X_WO.p = {0.01, 0.07, 0.125};
  object.grasps = {grasp};
  return object;
}

PpoOptions SmallPpo() {
  PpoOptions ppo = ToyPpo();
  ppo.envs = 6;
  ppo.horizon = 12;
  ppo.minibatch = 36;
  ppo.block_rows = 16;
  ppo.curriculum = true;  // advances after every iteration, so that episodes differ in gravity
  ppo.curriculum_threshold = -1;
  ppo.curriculum_period = 1;
  ppo.gravity_start = -0.5;
  ppo.gravity_step = 0.2;
  ppo.fall_share_start = 0.5;
  ppo.kl_end = 0.005;
  ppo.span = 8 * 6 * 12;  // eight iterations
  return ppo;
}

TaskOptions ShortTask() {
  TaskOptions task;
  task.episode_length = 30;  // so that timeouts are among what is resumed
  task.c_fall = -100;
  return task;
}

struct RealRun {
  RealRun(const HandModel& hand, int workers)
      : pool(workers),
        batch(ShortTask(), SimOptions(), hand, {CubeObject()}, SmallPpo().envs, 3, pool),
        env(batch) {}
  void Start(TrainState state) {
    trainer = std::make_unique<Trainer>(SmallPpo(), TaskDifficulty(), std::move(state), env, pool);
  }
  TrainState Fresh() const {
    return StartBase({SmallPpo(), {}, MakeShapeTable(batch.objects()), 3}, ToyPolicy(),
                     env.obs_size(), env.phys_size(), env.num_actions());
  }
  void Iterate(int count) {
    for (int i = 0; i < count; ++i) trainer->Iterate();
  }
  ThreadPool pool;
  ReorientBatch batch;
  ReorientEnv env;
  std::unique_ptr<Trainer> trainer;
};

TEST(ReorientTraining, ResumedRunEqualsTheUninterruptedOneByteForByteForAnyWorkers) {
  const TemporaryFolder folder("reorient");
  const HandModel hand = LoadHand(HandOptions());
  RealRun whole(hand, 1);
  whole.Start(whole.Fresh());
  whole.Iterate(6);
  WriteCheckpoint(folder / "whole.h5", whole.trainer->Snapshot(), ToyProvenance());
  EXPECT_FALSE(whole.trainer->state().window.empty());
  {
    RealRun first(hand, 2);
    first.Start(first.Fresh());
    first.Iterate(3);
    WriteCheckpoint(folder / "half.h5", first.trainer->Snapshot(), ToyProvenance());
  }
  RealRun second(hand, 2);
  second.Start(ReadCheckpoint(folder / "half.h5"));
  second.Iterate(3);
  WriteCheckpoint(folder / "resumed.h5", second.trainer->Snapshot(), ToyProvenance());
  EXPECT_EQ(ReadFile(folder / "whole.h5"), ReadFile(folder / "resumed.h5"));
  EXPECT_DOUBLE_EQ(whole.batch.mutable_options().c_fall, -87.5);  // three quarters of the way
  EXPECT_EQ(second.batch.mutable_options().c_fall, whole.batch.mutable_options().c_fall);
}

TEST(ReorientTraining, AFallCostsItsShareOfTheTasksPrice) {
  RealRun run(LoadHand(HandOptions()), 1);
  for (const double share : {0.25, 1.0}) {
    run.env.SetDifficulty({.fall_share = share});
    EXPECT_EQ(run.batch.mutable_options().c_fall, -100 * share);
  }
}

}  // namespace
}  // namespace dexremoe
