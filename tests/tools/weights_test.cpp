// Weights of a real training, and shares of its samples, by the tools themselves.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "eval/eval_file.h"
#include "rl/policy_file.h"
#include "training_fixture.h"

namespace dexremoe {
namespace {

class WeightsTool : public TrainingTest {
 protected:
  std::string Evaluate(const std::string& rest) const {
    return Bin() + "evaluate --config=" + Path("tiny.toml") +
           " --eval.episodes=6 --eval.tolerances=0.4 --objects=" + Path("objects.csv") + rest;
  }
};

TEST_F(WeightsTool, WeightsAreEvaluatedLikeTheirCheckpoint) {
  ASSERT_EQ(Run(TrainBase("base", "--samples=2560"), "base"), 0) << Slurp(Path("base.txt"));
  ASSERT_EQ(Run(Bin() + "export_weights --policy=" + Path("base.h5") +
                    " --out=" + Path("weights/base.h5"),
                "export"),
            0)
      << Slurp(Path("export.txt"));
  EXPECT_EQ(Slurp(Path("export.txt")), "base,2560,1\n");
  for (const char* folder : {"", "weights/"}) {
    const std::string file = Path(std::string(folder) + "base.h5");
    ASSERT_EQ(Run(Evaluate(" --policy=" + file + " --out=" + file + ".eval"), "evaluate"), 0)
        << Slurp(Path("evaluate.txt"));
  }
  EXPECT_EQ(Run(Bin() + "h5_diff " + "--a=" + Path("base.h5.eval") +
                    " --b=" + Path("weights/base.h5.eval"),
                "diff"),
            0)
      << Slurp(Path("diff.txt"));
}

TEST_F(WeightsTool, SamplesOfEarlierStagesCount) {
  ASSERT_EQ(Run(TrainBase("base", "--samples=256"), "base"), 0) << Slurp(Path("base.txt"));
  ASSERT_EQ(Run(TrainBase("longer", "--samples=512"), "longer"), 0) << Slurp(Path("longer.txt"));
  ASSERT_EQ(Run(Evaluate(" --policy=" + Path("base.h5") + " --earlier=" + Path("base.h5") + "," +
                         Path("longer.h5") + " --out=" + Path("eval.h5")),
                "evaluate"),
            0)
      << Slurp(Path("evaluate.txt"));
  EXPECT_EQ(ReadEval(Path("eval.h5")).samples, 256 + 256 + 512);
}

TEST_F(WeightsTool, AShareOfTheSamplesIsTrained) {
  ASSERT_EQ(Run(TrainBase("parent", "--samples=256"), "parent"), 0) << Slurp(Path("parent.txt"));
  ASSERT_EQ(Run(Bin() + "train_expert --config=" + Path("tiny.toml") +
                    " --base=" + Path("parent.h5") + " --objects=" + Path("objects.csv") +
                    " --out=" + Path("expert.h5") + " --samples=2560 --share=0.5",
                "expert"),
            0)
      << Slurp(Path("expert.txt"));
  EXPECT_EQ(ReadPolicy(Path("expert.h5")).samples, 1280);
}

}  // namespace
}  // namespace dexremoe
