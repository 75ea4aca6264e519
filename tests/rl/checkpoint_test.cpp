// Checkpoints: round trip, and one clear line for every way in which a file can be wrong.
#include "rl/checkpoint.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "fixture.h"
#include "io/atomic_file.h"
#include "rl/checkpoint_fields.h"
#include "rl/policy_file.h"

namespace dexremoe {
namespace {

// A file's structure and trainable blocks, without the blocks themselves.
void WriteNetworkHead(H5Writer& file, const PolicyStructure& structure) {
  WriteStructure(file, structure);
  const auto policy = MakePolicy<float>(structure);
  const std::int64_t blocks = static_cast<std::int64_t>(policy->trainable().size());
  file.Write("trainable", policy->trainable(), {blocks}, {"1", "block", ""});
}

TrainState TrainedState() {
  ToyRun run(ToyBase());
  run.Iterate(2);
  return run.trainer.Snapshot();
}

TEST(Checkpoint, RoundTripKeepsEverything) {
  const TemporaryFolder folder("round_trip");
  const TrainState state = TrainedState();
  WriteCheckpoint(folder / "a.h5", state, ToyProvenance());
  const TrainState read = ReadCheckpoint(folder / "a.h5");
  EXPECT_EQ(read.stage, "base");
  EXPECT_EQ(read.params, state.params);
  EXPECT_EQ(read.adam.m, state.adam.m);
  EXPECT_EQ(read.adam.step, state.adam.step);
  EXPECT_EQ(read.learning_rate, state.learning_rate);
  EXPECT_EQ(read.normalizers.obs.mean, state.normalizers.obs.mean);
  EXPECT_EQ(read.normalizers.value.count, state.normalizers.value.count);
  EXPECT_EQ(read.samples, 2 * 96 * 20);
  EXPECT_EQ(read.window.size(), state.window.size());
  EXPECT_EQ(read.settled, state.settled);
  EXPECT_EQ(read.best, state.best);
  EXPECT_EQ(read.curve, state.curve);
  EXPECT_EQ(read.table.names, state.table.names);
  EXPECT_EQ(read.environment, state.environment);
  WriteCheckpoint(folder / "b.h5", read, ToyProvenance());
  EXPECT_EQ(ReadFile(folder / "a.h5"), ReadFile(folder / "b.h5"));
}

TEST(Checkpoint, UntrainedStateCanBeStored) {
  const TemporaryFolder folder("untrained");
  const TrainState state = ToyBase();
  WriteCheckpoint(folder / "a.h5", state, ToyProvenance());
  const TrainState read = ReadCheckpoint(folder / "a.h5");
  EXPECT_EQ(read.params, state.params);
  EXPECT_TRUE(read.curve.empty());
  EXPECT_TRUE(read.adam.m.empty());
}

TEST(Checkpoint, AFileSaysHowManyPointsItsPolicySees) {
  const TemporaryFolder folder("points");
  for (const int points : {0, 7}) {
    PolicyOptions options = ToyPolicy();
    options.cloud_points = points;
    StageStart start = ToyStart();
    start.table.feature.assign(start.table.objects() * FeatureSize(points), 0.5f);
    const TrainState state = StartBase(start, options, 4, 2, 2);
    WriteCheckpoint(folder / "a.h5", state, ToyProvenance());
    EXPECT_EQ(ReadPolicyStructure(folder / "a.h5").cloud_points, points);
    EXPECT_EQ(ReadCheckpoint(folder / "a.h5").params, state.params);
  }
}

TEST(Checkpoint, OtherFormatsAndVersionsAreNamed) {
  const TemporaryFolder folder("format");
  const std::string path = folder / "a.h5";
  H5Writer(path, {"dexremoe.checkpoint", 2}, ToyProvenance()).Commit();
  EXPECT_EQ(MessageOf([&] { ReadCheckpoint(path); }),
            path + ": expected dexremoe.checkpoint version 1, found version 2; make it anew");
  H5Writer(path, {"dexremoe.mesh", 1}, ToyProvenance()).Commit();
  EXPECT_EQ(MessageOf([&] { ReadCheckpoint(path); }),
            path + ": expected format dexremoe.checkpoint, found dexremoe.mesh");
}

TEST(Checkpoint, MissingBlockIsNamed) {
  const TemporaryFolder folder("missing");
  const std::string path = folder / "a.h5";
  {
    H5Writer file(path, kCheckpointFormat, ToyProvenance());
    file.WriteString("stage", "base", {"", "", ""});
    WriteNetworkHead(file, ToyBase().structure);
    file.Commit();
  }
  EXPECT_EQ(MessageOf([&] { ReadCheckpoint(path); }),
            path + ": dataset 'params/encoder/cloud/0/weight' is missing");
}

TEST(Checkpoint, StructureOfOtherWidthsThanItsBlocksIsNamed) {
  const TemporaryFolder folder("widths");
  const std::string path = folder / "a.h5";
  {
    PolicyStructure structure = ToyBase().structure;
    structure.cloud_widths = {13, 8};
    H5Writer file(path, kCheckpointFormat, ToyProvenance());
    file.WriteString("stage", "base", {"", "", ""});
    WriteNetworkHead(file, structure);
    file.Write("params/encoder/cloud/0/weight", std::vector<float>(12 * 100), {12, 100},
               {"1", "", ""});
    file.Commit();
  }
  EXPECT_EQ(MessageOf([&] { ReadCheckpoint(path); }),
            path +
                ": dataset 'params/encoder/cloud/0/weight': expected extents [13, 100], found "
                "[12, 100]");
}

TEST(Checkpoint, BuildThatComputesSomethingElseIsNoticed) {
  const TemporaryFolder folder("example");
  const std::string path = folder / "a.h5";
  const TrainState state = ToyBase();
  const auto policy = MakePolicy<float>(state.structure);
  const PolicyExample example = MakeExample(state, *policy);
  {
    H5Writer file(path, kCheckpointFormat, ToyProvenance());
    WriteExample(file, example);
    file.Commit();
  }
  const H5Reader file(path, kCheckpointFormat);
  EXPECT_NO_THROW(CheckExample(file, example));
  PolicyExample other = example;
  other.mean[3] += 0.1f;
  EXPECT_NE(
      MessageOf([&] { CheckExample(file, other); }).find("example/mean: element 3: this build"),
      std::string::npos);
}

TEST(Checkpoint, ResumingWithOtherOptionsIsRefusedButForSamples) {
  const TemporaryFolder folder("options");
  const std::string path = folder / "a.h5";
  WriteCheckpoint(path, ToyBase(), ToyProvenance());
  EXPECT_NO_THROW(CheckSameOptions(path, "samples = 1\nseed = 1\n"));
  EXPECT_NO_THROW(CheckSameOptions(path, "samples = 9\nseed = 1\n"));
  EXPECT_EQ(MessageOf([&] { CheckSameOptions(path, "samples = 1\nseed = 2\n"); }),
            path +
                ": options: expected 'seed = 2' as now, found 'seed = 1'; start anew without "
                "--resume");
  EXPECT_NE(MessageOf([&] { CheckSameOptions(path, "samples = 1\n"); }), "no error");
}

}  // namespace
}  // namespace dexremoe
