// The training tools under mpirun.
#include <gmock/gmock.h>

#include "rl/checkpoint.h"
#include "training_fixture.h"

namespace dexremoe {
namespace {

using testing::HasSubstr;

class Mpi : public TrainingTest {
 protected:
  void SetUp() override {
    if (std::system("command -v mpirun >/dev/null 2>&1") != 0)
      GTEST_SKIP() << "Skipped: mpirun is not installed";
  }
  static std::string TwoRanks(const std::string& line) {
    return "mpirun --oversubscribe --allow-run-as-root --bind-to none -n 2 " + line;
  }
};

TEST_F(Mpi, TwoProcessesTrainLikeOneOnTheSameEnvironments) {
  // One update of all rows, after steps enough for episodes to end and start. In float32: how
  // bfloat16 rounds depends on how many rows a process has (seen with AMX).
  const std::string words =
      "--precision=f32 --ppo.horizon=24 --ppo.minibatch=768 --ppo.mini_epochs=1 --samples=768";
  ASSERT_EQ(Run(TrainBase("one", words), "one"), 0) << Slurp(Path("one.txt"));
  ASSERT_EQ(Run(TwoRanks(TrainBase("two", words)), "two"), 0) << Slurp(Path("two.txt"));
  const TrainState one = ReadCheckpoint(Path("one.h5")), two = ReadCheckpoint(Path("two.h5"));
  EXPECT_EQ(two.samples, 768);
  EXPECT_EQ(two.environment.size(), 2u);
  ASSERT_EQ(two.params.size(), one.params.size());
  ASSERT_EQ(one.params.size(), one.adam.m.size());
  for (std::size_t i = 0; i < one.params.size(); ++i) {
    ASSERT_NEAR(two.adam.m[i], one.adam.m[i], 1e-6) << i;         // a tenth of the gradient
    ASSERT_NEAR(two.params[i], one.params[i], 0.01 * 5e-3) << i;  // of Adam's first step
  }
  EXPECT_NEAR(two.normalizers.obs.mean[3], one.normalizers.obs.mean[3], 1e-9);
  EXPECT_FALSE(one.window.empty());
  EXPECT_EQ(two.window.size(), one.window.size());
  const std::string text = Slurp(Path("two.txt"));
  EXPECT_EQ(text.find("two.h5: 768 samples"), text.rfind("two.h5: 768 samples")) << text;
}

TEST_F(Mpi, AResumedRunOfTwoProcessesEqualsTheUninterruptedOneByteForByte) {
  ASSERT_EQ(Run(TwoRanks(TrainBase("whole", "--samples=768")), "whole"), 0);
  ASSERT_EQ(Run(TwoRanks(TrainBase("half", "--samples=512")), "half"), 0);
  EXPECT_NE(Slurp(Path("half.h5")), Slurp(Path("whole.h5")));
  // The number of samples is part of the file's provenance: as long as the whole run from here on.
  ASSERT_EQ(Run(TwoRanks(TrainBase("half", "--samples=768 --resume")), "half"), 0)
      << Slurp(Path("half.txt"));
  EXPECT_EQ(Slurp(Path("half.h5")), Slurp(Path("whole.h5")));

  EXPECT_EQ(Run(TrainBase("half", "--samples=1024 --resume"), "half"), 1);
  EXPECT_THAT(
      Slurp(Path("half.txt")),
      HasSubstr("half.h5: environment_end: expected a run of 1 processes as now, found one of 2"));
  EXPECT_EQ(Slurp(Path("half.h5")), Slurp(Path("whole.h5")));
}

TEST_F(Mpi, EnvironmentsThatCannotBeSharedEquallyAreRefused) {
  EXPECT_EQ(Run(TwoRanks(TrainBase("odd", "--ppo.envs=33")), "odd"), 1);
  EXPECT_THAT(Slurp(Path("odd.txt")),
              HasSubstr("ppo.envs: expected a multiple of 2 processes, found 33"));
}

}  // namespace
}  // namespace dexremoe
