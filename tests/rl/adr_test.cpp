// ADR's rule: when a bound moves, how far, where it stops; and that it can be resumed.
#include "rl/adr.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "fixture.h"
#include "io/atomic_file.h"

namespace dexremoe {
namespace {

AdrOptions Rule() {
  AdrOptions options;
  options.on = true;
  options.queue = 8;
  options.low = 1;
  options.high = 3;
  return options;
}

std::vector<EpisodeRecord> Episodes(int bound, int successes, int count) {
  EpisodeRecord record;
  record.bound = bound;
  record.successes = successes;
  return std::vector<EpisodeRecord>(count, record);
}

TEST(Adr, StartsAtThePlainTask) {
  const AdrState state = StartAdr();
  for (int i = 0; i < kNumRandom; ++i) {
    EXPECT_EQ(state.low[i], kRandomParameters[i].nominal);
    EXPECT_EQ(state.high[i], kRandomParameters[i].nominal);
  }
  EXPECT_EQ(state.history.size(), 1u);
}

TEST(Adr, FullQueueOfSuccessfulEpisodesWidensItsBoundAlone) {
  AdrState state = StartAdr();
  EXPECT_FALSE(UpdateAdr(Rule(), Episodes(2 * kMass + 1, 4, 7), 10, state));
  EXPECT_TRUE(UpdateAdr(Rule(), Episodes(2 * kMass + 1, 4, 1), 20, state));
  EXPECT_DOUBLE_EQ(state.high[kMass], 1 + kRandomParameters[kMass].step);
  EXPECT_EQ(state.low[kMass], 1);
  EXPECT_EQ(state.high[kFriction], 1);
  EXPECT_TRUE(state.queue[2 * kMass + 1].empty());
  EXPECT_TRUE(UpdateAdr(Rule(), Episodes(2 * kMass, 4, 8), 30, state));
  EXPECT_DOUBLE_EQ(state.low[kMass], 1 - kRandomParameters[kMass].step);
  ASSERT_EQ(state.history.size(), 3u);
  EXPECT_EQ(state.history.back().front(), 30);
  EXPECT_EQ(state.history.back().size(), AdrColumns().size());
}

TEST(Adr, FailingEpisodesShrinkABoundAndMiddlingOnesLeaveIt) {
  AdrState state = StartAdr();
  for (int i = 0; i < 3; ++i) UpdateAdr(Rule(), Episodes(2 * kGravity + 1, 5, 8), 0, state);
  const double step = kRandomParameters[kGravity].step;
  EXPECT_NEAR(state.high[kGravity], 3 * step, 1e-12);
  EXPECT_FALSE(UpdateAdr(Rule(), Episodes(2 * kGravity + 1, 2, 8), 0, state));
  EXPECT_TRUE(state.queue[2 * kGravity + 1].empty());
  EXPECT_TRUE(UpdateAdr(Rule(), Episodes(2 * kGravity + 1, 0, 8), 0, state));
  EXPECT_NEAR(state.high[kGravity], 2 * step, 1e-12);
}

TEST(Adr, BoundsStayBetweenThePlainTaskAndTheirLimits) {
  AdrState state = StartAdr();
  for (int bound = 0; bound < 2 * kNumRandom; ++bound) {
    if (!BoundMoves(bound)) continue;
    const RandomParameter& p = kRandomParameters[bound / 2];
    const double& value = bound % 2 == 0 ? state.low[bound / 2] : state.high[bound / 2];
    EXPECT_FALSE(UpdateAdr(Rule(), Episodes(bound, 0, 8), 0, state)) << p.name;
    for (int i = 0; i < 200; ++i) UpdateAdr(Rule(), Episodes(bound, 9, 8), 0, state);
    EXPECT_EQ(value, bound % 2 == 0 ? p.least : p.most) << p.name;
    for (int i = 0; i < 200; ++i) UpdateAdr(Rule(), Episodes(bound, 0, 8), 0, state);
    EXPECT_EQ(value, p.nominal) << p.name;
  }
}

TEST(Adr, LogarithmicBoundsMoveByAFactor) {
  AdrState state = StartAdr();
  for (int i = 0; i < 2; ++i) UpdateAdr(Rule(), Episodes(2 * kDamping, 9, 8), 0, state);
  EXPECT_NEAR(state.low[kDamping], std::exp(-2 * kRandomParameters[kDamping].step), 1e-12);
}

TEST(Adr, EpisodesWithinTheRangesDoNotCount) {
  AdrState state = StartAdr();
  EXPECT_FALSE(UpdateAdr(Rule(), Episodes(-1, 9, 100), 0, state));
  for (const auto& queue : state.queue) EXPECT_TRUE(queue.empty());
}

TEST(Adr, ThresholdsOutOfOrderAreAnError) {
  AdrOptions options = Rule();
  options.low = 4;
  EXPECT_THROW(options.Check(), UsageError);
}

// The toy task with boundary episodes by number; it remembers the ranges it was given.
class RangedToy final : public VecEnv {
 public:
  RangedToy(int envs, std::uint64_t seed) : toy_(envs, seed) {}
  int num_envs() const override { return toy_.num_envs(); }
  int obs_size() const override { return toy_.obs_size(); }
  int phys_size() const override { return toy_.phys_size(); }
  int num_actions() const override { return toy_.num_actions(); }
  void ResetAll() override { toy_.ResetAll(); }
  const StepResult& Step(const std::vector<float>& actions) override { return toy_.Step(actions); }
  const std::vector<float>& obs() const override { return toy_.obs(); }
  const std::vector<float>& phys() const override { return toy_.phys(); }
  const std::vector<int>& object() const override { return toy_.object(); }
  std::vector<EpisodeRecord> TakeRecords() override {
    std::vector<EpisodeRecord> records = toy_.TakeRecords();
    for (EpisodeRecord& record : records)
      record.bound = record.env % 3 == 0 ? 2 * kMass + 1 : 2 * kForce + 1;
    return records;
  }
  void SetDifficulty(const TaskDifficulty& difficulty) override { toy_.SetDifficulty(difficulty); }
  void SetRandomRanges(const std::vector<double>&, const std::vector<double>& high) override {
    mass_high = high[kMass];
  }
  std::vector<std::uint8_t> Save() const override { return toy_.Save(); }
  void Restore(const std::vector<std::uint8_t>& bytes) override { toy_.Restore(bytes); }

  double mass_high = 0;

 private:
  ToyEnv toy_;
};

struct AdrRun {
  AdrRun(TrainState state, int workers)
      : pool(workers),
        env(ToyPpo().envs, 7),
        trainer(ToyPpo(), {}, std::move(state), env, pool, Alone(), Options()) {}
  // Every decision widens, so that a lost queue would show.
  static AdrOptions Options() {
    AdrOptions options = Rule();
    options.queue = 50;
    options.low = options.high = -1;
    return options;
  }
  ThreadPool pool;
  RangedToy env;
  Trainer trainer;
};

TEST(Adr, ResumedRunEqualsTheUninterruptedOneByteForByte) {
  const TemporaryFolder folder("adr");
  AdrRun whole(ToyBase(), 2);
  for (int i = 0; i < 6; ++i) whole.trainer.Iterate();
  WriteCheckpoint(folder / "whole.h5", whole.trainer.Snapshot(), ToyProvenance());
  {
    AdrRun first(ToyBase(), 1);
    for (int i = 0; i < 3; ++i) first.trainer.Iterate();
    WriteCheckpoint(folder / "half.h5", first.trainer.Snapshot(), ToyProvenance());
  }
  AdrRun second(ReadCheckpoint(folder / "half.h5"), 2);
  EXPECT_GT(second.env.mass_high, 1);  // told at once
  for (int i = 0; i < 3; ++i) second.trainer.Iterate();
  WriteCheckpoint(folder / "resumed.h5", second.trainer.Snapshot(), ToyProvenance());
  EXPECT_EQ(ReadFile(folder / "whole.h5"), ReadFile(folder / "resumed.h5"));
  EXPECT_EQ(second.env.mass_high, whole.env.mass_high);
  EXPECT_EQ(whole.trainer.state().adr.high[kMass], whole.env.mass_high);
  EXPECT_GT(whole.trainer.state().adr.history.size(), 2u);
}

}  // namespace
}  // namespace dexremoe
