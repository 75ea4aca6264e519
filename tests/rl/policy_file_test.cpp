// Weights are the policy of their checkpoint, and nothing else.
#include "rl/policy_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "fixture.h"
#include "rl/checkpoint_fields.h"
#include "rl/policy_runner.h"

namespace dexremoe {
namespace {

TrainState TrainedGate(const TrainState& base) {
  const std::vector<TrainState> experts(3, StartExpert(ToyStart(), base, "base.h5"));
  ToyRun run(StartGate(ToyStart(), ToyPolicy(), experts, {"a.h5", "b.h5", "c.h5"}));
  run.Iterate(2);
  return run.trainer.Snapshot();
}

// The same actions, bit for bit, and the same weights of the gate.
void ExpectTheSamePolicy(const std::string& a, const std::string& b) {
  ThreadPool pool(1);
  PolicyRunner one(a, ToyObjects(), pool), other(b, ToyObjects(), pool);
  ToyEnv env(50, 3);
  env.ResetAll();
  std::vector<float> of_one, of_other;
  one.Act(env.obs(), env.phys(), env.object(), of_one);
  other.Act(env.obs(), env.phys(), env.object(), of_other);
  EXPECT_EQ(of_one, of_other);
  EXPECT_EQ(one.GateWeights(), other.GateWeights());
  EXPECT_EQ(one.samples(), other.samples());
}

TEST(Weights, ActAsTheCheckpointTheyAreFrom) {
  const TemporaryFolder folder("weights");
  ToyRun run(ToyBase());
  run.Iterate(2);
  const TrainState base = run.trainer.Snapshot();
  for (const TrainState& state : {base, TrainedGate(base)}) {
    WriteCheckpoint(folder / "a.h5", state, ToyProvenance());
    ExportWeights(folder / "a.h5", folder / "w.h5", ToyProvenance());
    ExpectTheSamePolicy(folder / "a.h5", folder / "w.h5");
    const TrainState read = ReadPolicy(folder / "w.h5");
    EXPECT_EQ(read.params, state.params);
    EXPECT_EQ(read.stage, state.stage);
    EXPECT_EQ(read.card.network, state.card.network);
    EXPECT_EQ(read.seed, state.seed);
    EXPECT_EQ(ReadPolicyStructure(folder / "w.h5").hidden, state.structure.hidden);
  }
}

TEST(Weights, HoldWhatTheyWereTrainedWithAndNothingOfTheTraining) {
  const TemporaryFolder folder("stripped");
  ToyRun run(ToyBase());
  run.Iterate(1);
  WriteCheckpoint(folder / "a.h5", run.trainer.Snapshot(), ToyProvenance());
  ExportWeights(folder / "a.h5", folder / "w.h5", {"export_weights", "out = w.h5\n", 1, {}});
  const H5Reader file(folder / "w.h5", kWeightsFormat);
  EXPECT_EQ(file.ReadString("training/tool"), "test");
  EXPECT_EQ(file.ReadString("training/options"), ToyProvenance().options);
  for (const char* dataset : {"adam/m", "environment", "curve/row", "window", "curriculum/decided"})
    EXPECT_FALSE(file.Has(dataset)) << dataset;
  EXPECT_LT(std::filesystem::file_size(folder / "w.h5"),
            std::filesystem::file_size(folder / "a.h5"));
}

TEST(Weights, OtherParametersThanTheHashSaysAreNoticed) {
  const TemporaryFolder folder("damaged");
  {
    H5Writer file(folder / "w.h5", kWeightsFormat, ToyProvenance());
    WritePolicyPart(file, ToyBase());
    file.WriteString("params_hash", "1234", {"", "", ""});
    file.Commit();
  }
  EXPECT_THAT(MessageOf([&] { ReadPolicy(folder / "w.h5"); }),
              testing::HasSubstr("w.h5: params: expected hash 1234, found "));
}

TEST(Weights, AreNoCheckpointToTrainOnFrom) {
  const TemporaryFolder folder("refused");
  WriteCheckpoint(folder / "a.h5", ToyBase(), ToyProvenance());
  ExportWeights(folder / "a.h5", folder / "w.h5", ToyProvenance());
  EXPECT_EQ(MessageOf([&] { ReadCheckpoint(folder / "w.h5"); }),
            (folder / "w.h5") + ": expected format dexremoe.checkpoint, found dexremoe.weights");
}

}  // namespace
}  // namespace dexremoe
