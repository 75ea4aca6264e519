// What a rollout records: log-probabilities, ends of episodes, the bootstrap at timeouts.
#include "rl/rollout.h"

#include <gtest/gtest.h>

#include "fixture.h"
#include "io/csv.h"
#include "rl/curve_file.h"
#include "rl/ppo_loss.h"

namespace dexremoe {
namespace {

TEST(Rollout, RecordsTheLogProbabilityOfWhatItDid) {
  ToyRun run(ToyBase());
  const ShapeRows shapes(run.trainer.state().table, run.trainer.state().normalizers.feature, 5, 6);
  Rollout rollout(ToyPpo(), run.trainer.policy(), run.env, run.pool);
  const RolloutBatch& b = rollout.Collect(run.trainer.state(), shapes.inputs(), nullptr, nullptr);
  const ActionSpread<float> spread(2, b.log_std.data());
  for (std::size_t r = 0; r < b.log_prob.size(); ++r)
    EXPECT_FLOAT_EQ(b.log_prob[r], LogProbability(spread, &b.action[2 * r], &b.mean[2 * r]));
}

// All toy episodes time out at step 20 together (the noise is too small to leave the field). The
// last reward must hold gamma times the value of the last state, which a second rollout through the
// same states, cut there, reports as its last value only before the reset: so compare with the
// environment's own last observation.
TEST(Rollout, TimeoutsAreBootstrappedWithTheLastStateAndFallsAreNot) {
  PpoOptions ppo = ToyPpo();
  ppo.horizon = 19;
  ToyRun run(ToyBase(ppo), 1, ppo);
  const TrainState& state = run.trainer.state();
  const ShapeRows shapes(state.table, state.normalizers.feature, 5, 6);
  Rollout rollout(ppo, run.trainer.policy(), run.env, run.pool);
  rollout.Collect(state, shapes.inputs(), nullptr, nullptr);
  const std::vector<std::uint8_t> before_last_step = run.env.Save();

  ppo.horizon = 1;
  Rollout one(ppo, run.trainer.policy(), run.env, run.pool);
  const RolloutBatch& batch = one.Collect(state, shapes.inputs(), nullptr, nullptr);
  ToyEnv referee(ppo.envs, 7);
  referee.Restore(before_last_step);
  const StepResult& raw = referee.Step(batch.action);
  ASSERT_GT(raw.ended.size(), 50u);
  int timeouts = 0;
  for (std::size_t i = 0; i < raw.ended.size(); ++i) {
    const int env = raw.ended[i];
    EXPECT_EQ(batch.done[env], 1);
    if (raw.end[env] == EpisodeEnd::kFall) {
      EXPECT_EQ(batch.reward[env], raw.reward[env]);
      continue;
    }
    ++timeouts;
    std::vector<float> obs(&raw.last_obs[4 * i], &raw.last_obs[4 * i] + 4);
    std::vector<float> phys(&raw.last_phys[2 * i], &raw.last_phys[2 * i] + 2);
    Normalize(state.normalizers.obs, 5, 1, obs.data(), obs.data());
    Normalize(state.normalizers.phys, 5, 1, phys.data(), phys.data());
    float mean[2], value;
    Workspace<float> work;
    run.trainer.policy().Forward(state.params.data(), shapes.inputs(),
                                 {1, obs.data(), phys.data(), &referee.object()[env], nullptr},
                                 work, mean, &value);
    DenormalizeValues(state.normalizers.value, &value, 1);
    EXPECT_NEAR(batch.reward[env], raw.reward[env] + 0.9 * value, 1e-5);
  }
  EXPECT_GT(timeouts, 50);
}

TEST(Rollout, MomentsOfTheBaseFollowTheRawInputs) {
  ToyRun run(ToyBase());
  run.Iterate(1);
  const Normalizers& norm = run.trainer.state().normalizers;
  EXPECT_NEAR(norm.obs.count, 96 * 20, 1);
  // Goals are uniform in [-1, 1].
  EXPECT_NEAR(norm.phys.mean[0], 0, 0.15);
  EXPECT_NEAR(norm.phys.variance[0], 1.0 / 3, 0.08);
}

TEST(CurveFile, KeepsTheTimesOfTheRowsThatAResumedRunHas) {
  const TemporaryFolder folder("curve");
  const std::string path = folder / "curve.csv";
  CurveRow row = {};
  CurveFile first(path, {});
  first.Add(row, {2, 1}, 100);
  first.Add(row, {1, 1}, 100);
  first.Write();
  CurveFile second(path, {row, row});
  second.Add(row, {0.5, 0.25}, 100);
  second.Write();
  const CsvTable table = CsvTable::Read(path);
  EXPECT_EQ(table.Numbers("seconds"), (std::vector<double>{3, 5, 5.75}));
  EXPECT_EQ(table.Numbers("rollout_rate"), (std::vector<double>{50, 100, 200}));
}

TEST(CurveFile, WithoutAPathNothingIsWritten) {
  CurveFile curve("", {});
  curve.Add({}, {1, 1}, 10);
  EXPECT_NO_THROW(curve.Write());
}

}  // namespace
}  // namespace dexremoe
