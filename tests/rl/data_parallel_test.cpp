// Training over several ranks is training on their environments together.
#include <gtest/gtest.h>

#include "fixture.h"
#include "io/atomic_file.h"
#include "thread_communicator.h"

namespace dexremoe {
namespace {

// One minibatch per mini-epoch: then its rows do not depend on how they are shuffled. Two
// iterations: in a third, a clipped ratio or value may fall on the other side, as it may for
// another ppo.block_rows.
PpoOptions FullBatch() {
  PpoOptions ppo = ToyPpo();
  ppo.mini_epochs = 2;
  ppo.minibatch = ppo.envs * ppo.horizon;
  return ppo;
}

// Runs `iterations` on `ranks` ranks from `start`; what each rank ends with.
std::vector<TrainState> Train(int ranks, const TrainState& start, const PpoOptions& ppo,
                              int iterations) {
  std::vector<TrainState> states(ranks);
  RunRanks(ranks, [&](Communicator& communicator) {
    const int envs = ppo.envs / ranks;
    ThreadPool pool(1);
    ToyEnv env(envs, 7, communicator.rank() * envs);
    Trainer trainer(ppo, {}, start, env, pool, communicator);
    for (int i = 0; i < iterations; ++i) trainer.Iterate();
    states[communicator.rank()] = trainer.Snapshot();
  });
  return states;
}

void ExpectClose(const std::vector<float>& a, const std::vector<float>& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], tolerance) << i;
}

TEST(DataParallel, SeveralRanksTrainLikeOneRankOnAllEnvironments) {
  const TrainState start = ToyBase(FullBatch());
  const TrainState one = Train(1, start, FullBatch(), 2)[0];
  double moved = 0;
  for (std::size_t i = 0; i < one.params.size(); ++i)
    moved = std::max<double>(moved, std::abs(one.params[i] - start.params[i]));
  EXPECT_GT(moved, 2e-3);
  for (const int ranks : {2, 3}) {
    const TrainState several = Train(ranks, start, FullBatch(), 2)[0];
    ExpectClose(several.params, one.params, 1e-6);
    EXPECT_EQ(several.samples, one.samples);
    EXPECT_EQ(several.learning_rate, one.learning_rate);
    EXPECT_DOUBLE_EQ(several.normalizers.obs.count, one.normalizers.obs.count);
    EXPECT_NEAR(several.normalizers.obs.mean[0], one.normalizers.obs.mean[0], 1e-9);
    EXPECT_EQ(several.window.size(), one.window.size());
    for (std::size_t row = 0; row < one.curve.size(); ++row)
      for (std::size_t i = 0; i < kCurveColumns.size(); ++i)
        EXPECT_NEAR(several.curve[row][i], one.curve[row][i],
                    1e-5 * (0.1 + std::abs(one.curve[row][i])))
            << kCurveColumns[i] << " of iteration " << row;
  }
}

TEST(DataParallel, AllRanksEndInTheSameBits) {
  const std::vector<TrainState> states = Train(3, ToyBase(), ToyPpo(), 3);
  for (const TrainState& state : states) {
    EXPECT_EQ(state.params, states[0].params);
    EXPECT_EQ(state.adam.v, states[0].adam.v);
    EXPECT_EQ(state.normalizers.phys.variance, states[0].normalizers.phys.variance);
    EXPECT_EQ(state.learning_rate, states[0].learning_rate);
    EXPECT_EQ(state.curve, states[0].curve);
    EXPECT_EQ(state.best, states[0].best);
  }
  EXPECT_EQ(states[0].environment.size(), 3u);
}

TEST(DataParallel, AResumedRunOfTwoRanksEqualsTheUninterruptedOneByteForByte) {
  const TemporaryFolder folder("ranks");
  PpoOptions ppo = ToyPpo();
  ppo.curriculum = true;
  ppo.curriculum_threshold = 0;
  ppo.curriculum_period = 3000;
  WriteCheckpoint(folder / "whole.h5", Train(2, ToyBase(ppo), ppo, 6)[0], ToyProvenance());
  WriteCheckpoint(folder / "half.h5", Train(2, ToyBase(ppo), ppo, 3)[0], ToyProvenance());
  const TrainState half = ReadCheckpoint(folder / "half.h5");
  WriteCheckpoint(folder / "resumed.h5", Train(2, half, ppo, 3)[0], ToyProvenance());
  EXPECT_EQ(ReadFile(folder / "whole.h5"), ReadFile(folder / "resumed.h5"));
  EXPECT_NE(ReadFile(folder / "whole.h5"), ReadFile(folder / "half.h5"));
}

}  // namespace
}  // namespace dexremoe
