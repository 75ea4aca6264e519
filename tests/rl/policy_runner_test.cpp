// Policies read back from checkpoints act as they did in training.
#include "rl/policy_runner.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fixture.h"
#include "rl/rollout.h"

namespace dexremoe {
namespace {

TEST(PolicyRunner, ActsWithTheMeansOfTheRollout) {
  const TemporaryFolder folder("runner");
  ToyRun run(ToyBase());
  run.Iterate(3);
  WriteCheckpoint(folder / "base.h5", run.trainer.Snapshot(), ToyProvenance());
  PolicyRunner runner(folder / "base.h5", ToyObjects(), run.pool);
  EXPECT_EQ(runner.kind(), "actor_critic");
  EXPECT_EQ(runner.gates(), 0);
  EXPECT_TRUE(runner.GateWeights().empty());
  EXPECT_EQ(runner.samples(), run.trainer.state().samples);

  std::vector<float> actions;
  runner.Act(run.env.obs(), run.env.phys(), run.env.object(), actions);
  const ShapeRows shapes(run.trainer.state().table, run.trainer.state().normalizers.feature, 5, 6);
  Rollout rollout(ToyPpo(), run.trainer.policy(), run.env, run.pool);
  const RolloutBatch& batch =
      rollout.Collect(run.trainer.state(), shapes.inputs(), nullptr, nullptr);
  for (std::size_t i = 0; i < actions.size(); ++i) EXPECT_EQ(actions[i], batch.mean[i]);
}

TEST(PolicyRunner, NoiseHasThePolicysSpread) {
  const TemporaryFolder folder("noise");
  WriteCheckpoint(folder / "base.h5", ToyBase(), ToyProvenance());
  ThreadPool pool(1);
  PolicyRunner runner(folder / "base.h5", ToyObjects(), pool);
  ToyEnv env(2000, 3);
  env.ResetAll();
  std::vector<float> mean, noisy, again;
  runner.Act(env.obs(), env.phys(), env.object(), mean);
  runner.Sample(env.obs(), env.phys(), env.object(), 5, 0, noisy);
  runner.Sample(env.obs(), env.phys(), env.object(), 5, 0, again);
  EXPECT_EQ(noisy, again);
  double square = 0;
  for (std::size_t i = 0; i < mean.size(); ++i)
    square += std::pow(noisy[i] - mean[i], 2) / static_cast<double>(mean.size());
  EXPECT_NEAR(std::sqrt(square), std::exp(ToyPolicy().log_std), 0.02);
}

TEST(PolicyRunner, GateWeightsFollowTheObjects) {
  const TemporaryFolder folder("gate");
  const std::vector<TrainState> experts(3, StartExpert(ToyStart(), ToyBase(), "base.h5"));
  TrainState gate = StartGate(ToyStart(), ToyPolicy(), experts, {"a.h5", "b.h5", "c.h5"});
  const auto policy = MakePolicy<float>(gate.structure);
  for (const ParamBlock& block : policy->layout().blocks())
    if (block.name.starts_with("gate/"))
      for (std::int64_t i = 0; i < block.size(); ++i)
        gate.params[block.offset + i] += 0.3f * std::sin(static_cast<float>(i));
  WriteCheckpoint(folder / "gate.h5", gate, ToyProvenance());
  ThreadPool pool(2);
  std::vector<TaskObject> objects = ToyObjects();
  PolicyRunner runner(folder / "gate.h5", objects, pool);
  ASSERT_EQ(runner.gates(), 3);
  ASSERT_EQ(runner.GateWeights().size(), 12u);
  EXPECT_NE(runner.GateWeights()[0], runner.GateWeights()[3]);
  const auto alone = runner.WeightsOf(objects[1].feature, {objects[1].category});
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(alone[i], runner.GateWeights()[3 + i], 1e-5);

  // Equal experts: whatever the weights, the mixture acts as the expert.
  WriteCheckpoint(folder / "expert.h5", experts[0], ToyProvenance());
  PolicyRunner expert(folder / "expert.h5", objects, pool);
  ToyEnv env(300, 3);
  env.ResetAll();
  std::vector<float> one, mixed;
  expert.Act(env.obs(), env.phys(), env.object(), one);
  runner.Act(env.obs(), env.phys(), env.object(), mixed);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_NEAR(one[i], mixed[i], 1e-5);
}

TEST(PolicyRunner, APredictedCategoryActsLikeTheLabelItNames) {
  const TemporaryFolder folder("predicted");
  WriteCheckpoint(folder / "base.h5", ToyBase(), ToyProvenance());
  ThreadPool pool(1);
  ToyEnv env(8, 3);
  env.ResetAll();
  const auto act = [&](const std::vector<TaskObject>& objects) {
    PolicyRunner runner(folder / "base.h5", objects, pool);
    std::vector<float> actions;
    runner.Act(env.obs(), env.phys(), env.object(), actions);
    return actions;
  };
  const std::vector<TaskObject> labelled = ToyObjects();
  std::vector<TaskObject> predicted = labelled, wrong = labelled;
  for (TaskObject& object : predicted) {
    object.category_input.assign(kNumCategories, 0.0f);
    object.category_input[object.category] = 1;
    object.category = 0;
  }
  for (TaskObject& object : wrong) object.category_input = {0, 0, 0, 0, 0, 1};
  EXPECT_EQ(act(predicted), act(labelled));
  EXPECT_NE(act(wrong), act(labelled));
}

}  // namespace
}  // namespace dexremoe
