// The baselines as trainings: each starts, learns, resumes, and sees what its definition says.
#include "rl/baseline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string_view>

#include "base/error.h"
#include "fixture.h"
#include "io/atomic_file.h"
#include "rl/policy_runner.h"

namespace dexremoe {
namespace {

PolicyOptions SmallOptions() {
  PolicyOptions p = ToyPolicy();
  p.ranks = {2, 3, 4, 5};
  p.category_rank = 3;
  return p;
}

TrainState Start(const std::string& method, const TrainState* base = nullptr) {
  return StartBaseline(method, ToyStart(), SmallOptions(), 4, 2, 2, {0, 1}, base, "base.h5");
}

// The sign of an object's actions lies in its shape and category alone.
TEST(Baseline, MethodsThatSeeShapesLearnTheToyTaskAndBlindOnesCannot) {
  for (const std::string& method : BaselineMethods()) {
    if (StartsFromBase(method)) continue;
    SCOPED_TRACE(method);
    ToyRun run(Start(method));
    run.Iterate(30);
    const TrainState& state = run.trainer.state();
    EXPECT_EQ(state.stage, method);
    const double gain = state.curve.back()[8] - state.curve.front()[8];
    EXPECT_EQ(gain > 3, state.structure.see_cloud) << gain;
  }
}

TEST(Baseline, RoutedMethodsLogEntropyLoadAndLosses) {
  for (const char* method : {"sparse_moe", "switch", "mlore", "mmoe", "privshape"}) {
    SCOPED_TRACE(method);
    ToyRun run(Start(method));
    run.Iterate(2);
    const auto last = [&](std::string_view column) {
      const auto found = std::find(kCurveColumns.begin(), kCurveColumns.end(), column);
      return run.trainer.state().curve.back().at(found - kCurveColumns.begin());
    };
    const bool routed = std::string(method) != "privshape";
    const double entropy = last("routing_entropy"), loss = last("auxiliary_loss");
    const double least = last("expert_load_least"), most = last("expert_load_most");
    EXPECT_EQ(entropy > 0, routed);
    EXPECT_EQ(most > 0, routed);
    EXPECT_LE(least, most);
    EXPECT_LE(most, 1 + 1e-9);
    EXPECT_EQ(loss > 0, routed && std::string(method) != "mmoe");
  }
}

TEST(Baseline, ResumedMixtureEqualsTheUninterruptedOneByteForByte) {
  for (const char* method : {"sparse_moe", "switch", "mlore", "mmoe"}) {
    SCOPED_TRACE(method);
    const TemporaryFolder folder("resume_mixture");
    ToyRun whole(Start(method), 2);
    whole.Iterate(4);
    WriteCheckpoint(folder / "whole.h5", whole.trainer.Snapshot(), ToyProvenance());
    {
      ToyRun first(Start(method), 1);
      first.Iterate(2);
      WriteCheckpoint(folder / "half.h5", first.trainer.Snapshot(), ToyProvenance());
    }
    ToyRun second(ReadCheckpoint(folder / "half.h5"), 3);
    second.Iterate(2);
    WriteCheckpoint(folder / "resumed.h5", second.trainer.Snapshot(), ToyProvenance());
    EXPECT_EQ(ReadFile(folder / "whole.h5"), ReadFile(folder / "resumed.h5"));
  }
}

TEST(Baseline, InputsAreThoseOfTheDefinitions) {
  EXPECT_FALSE(Start("privfeat").structure.see_cloud);
  EXPECT_FALSE(Start("privfeat").structure.see_category);
  EXPECT_TRUE(Start("privshape").structure.see_cloud);
  EXPECT_FALSE(Start("privshape").structure.see_category);
  EXPECT_EQ(Start("dr").structure.phys_seen, (std::vector<int>{0, 1}));
  EXPECT_FALSE(Start("adr").structure.see_cloud);
  EXPECT_TRUE(Start("switch").structure.see_category);
  EXPECT_TRUE(Start("switch").structure.phys_seen.empty());
}

TEST(Baseline, BaseLongIsTheBaseTrainedOn) {
  ToyRun base(ToyBase());
  base.Iterate(3);
  const TrainState& parent = base.trainer.state();
  const TrainState start = Start("base_long", &parent);
  EXPECT_EQ(start.params, parent.params);
  EXPECT_EQ(start.adam.m, parent.adam.m);
  EXPECT_EQ(start.learning_rate, parent.learning_rate);
  EXPECT_EQ(start.samples, parent.samples);
  ToyRun on(start);
  on.Iterate(2);
  EXPECT_EQ(on.trainer.state().samples, parent.samples / 3 * 5);
  EXPECT_EQ(on.trainer.state().curve.size(), 5u);
  EXPECT_NE(on.trainer.state().params, parent.params);
}

TEST(Baseline, ResidualStartsAtTheBaseAndLeavesItAlone) {
  ToyRun base(ToyBase());
  base.Iterate(3);
  const TrainState& parent = base.trainer.state();
  const TrainState start = Start("res", &parent);
  EXPECT_EQ(start.samples, parent.samples);
  ToyRun run(start);
  run.Iterate(3);
  const TrainState& state = run.trainer.state();
  const auto policy = MakePolicy<float>(state.structure);
  for (const ParamBlock& block : policy->layout().blocks()) {
    const auto begin = state.params.begin() + block.offset;
    const bool same = std::equal(begin, begin + block.size(), start.params.begin() + block.offset);
    EXPECT_EQ(same, !(block.name.starts_with("residual/") || block.name == "log_std"))
        << block.name;
  }
}

TEST(Baseline, ResidualOfAMixtureIsAnError) {
  const TrainState mixture = Start("switch");
  EXPECT_THROW(Start("res", &mixture), Error);
}

// What a checkpoint must not see does not matter when it acts.
TEST(Baseline, RunnersObeyTheCheckpointsMask) {
  const TemporaryFolder folder("mask");
  ToyRun run(Start("privshape"));
  run.Iterate(1);
  WriteCheckpoint(folder / "privshape.h5", run.trainer.state(), ToyProvenance());
  const auto act = [&](int category) {
    std::vector<TaskObject> objects(1);
    const ShapeTable table = ToyTable({2});
    objects[0].name = "toy";
    objects[0].category = category;
    objects[0].feature = table.feature;
    ThreadPool pool(1);
    PolicyRunner runner(folder / "privshape.h5", objects, pool);
    std::vector<float> actions;
    runner.Act({0.1f, 0.2f, 0.3f, 0.4f}, {0.5f, 0.6f}, {0}, actions);
    return actions;
  };
  EXPECT_EQ(act(0), act(4));
}

TEST(Baseline, CardSaysWhatTheMethodIs) {
  const TemporaryFolder folder("card");
  TrainState state = Start("sparse_moe");
  PpoOptions ppo = ToyPpo();
  ppo.curriculum = true;
  ppo.curriculum_objects = 1;
  ppo.span = 1e6;
  ppo.fall_share_start = 0.25;
  ppo.kl_threshold = 0.02;
  ppo.kl_end = 0.002;
  state.card = DescribeMethod("sparse_moe", state.structure, ppo);
  WriteCheckpoint(folder / "sparse.h5", state, ToyProvenance());
  const std::string table = MethodTable({folder / "sparse.h5"});
  for (const char* words :
       {"noisy top-2 of 4 experts", "0.01 CV^2 importance + 0.01 CV^2 load",
        "o_t, e_phys, shape, category", "objects from 1 doubling",
        "falls at 0.25 of their price until late", "KL threshold from 0.02 to 0.002"})
    EXPECT_NE(table.find(words), std::string::npos) << words << "\n" << table;
}

TEST(Baseline, TheTableOfMethodsSaysWhichAreMissing) {
  const TemporaryFolder folder("methods");
  WriteCheckpoint(folder / "base.h5", ToyBase(), ToyProvenance());
  const std::vector<std::string> files = {folder / "gone.h5", folder / "base.h5"};
  const std::string table = MethodTable(files, true);
  EXPECT_NE(table.find("| gone | missing |"), std::string::npos) << table;
  EXPECT_NE(table.find("| base | "), std::string::npos) << table;
  EXPECT_THROW(MethodTable(files), Error);
}

}  // namespace
}  // namespace dexremoe
