// Last and best checkpoint: which state is the best, and that a kill between files does no harm.
#include "rl/run_files.h"

#include <gtest/gtest.h>

#include "fixture.h"
#include "io/atomic_file.h"

namespace dexremoe {
namespace {

namespace fs = std::filesystem;

// Iterates and saves, so that every state is seen by the files.
void IterateAndSave(ToyRun& run, RunFiles& files, int count) {
  for (int i = 0; i < count; ++i) {
    run.Iterate(1);
    files.Add(run.trainer, 1920);
    files.Save(run.trainer.Snapshot());
  }
}

// Files NAME.h5 and NAME.best.h5.
RunFiles FilesOf(const std::string& name, const ToyRun& run) {
  return RunFiles({name + ".h5", name + ".best.h5", "", "", name + ".snapshots"}, ToyProvenance(),
                  {0, 5000}, run.trainer.state());
}

TEST(RunFiles, TheBestFileHoldsTheStateOfMostSuccesses) {
  const TemporaryFolder folder("best");
  ToyRun run(ToyBase());
  RunFiles files = FilesOf(folder / "run", run);
  IterateAndSave(run, files, 30);
  const TrainState best = ReadCheckpoint(folder / "run.best.h5");
  double highest = 0;
  for (const CurveRow& row : run.trainer.state().curve) highest = std::max(highest, row[2]);
  EXPECT_GT(highest, run.trainer.state().curve.front()[2]);
  EXPECT_EQ(best.curve.back()[2], highest);
  EXPECT_EQ(best.best.successes, highest);
  EXPECT_TRUE(best.environment.empty());
}

TEST(RunFiles, NoStateIsTheBestBeforeTheWindowIsFull) {
  const TemporaryFolder folder("unfilled");
  PpoOptions ppo = ToyPpo();
  ppo.stats_window = 1000;  // 96 episodes end in each iteration
  ToyRun run(ToyBase(ppo), 2, ppo);
  WriteFile(folder / "run.best.h5", "of an earlier run");
  RunFiles files = FilesOf(folder / "run", run);
  IterateAndSave(run, files, 9);
  EXPECT_FALSE(fs::exists(folder / "run.best.h5"));
  IterateAndSave(run, files, 3);
  EXPECT_TRUE(fs::exists(folder / "run.best.h5"));
}

TEST(RunFiles, AHarderTaskOutranksMoreSuccessesOnceItsEpisodesFillTheWindow) {
  PpoOptions ppo = ToyPpo();
  ppo.curriculum = true;
  ppo.curriculum_threshold = 0;
  ppo.curriculum_period = 9600;  // moves after every fifth iteration
  ppo.stats_window = 140;        // with the episodes begun before: filled by the third
  ToyRun run(ToyBase(ppo), 2, ppo);
  double progress = 0;            // of the best state
  double before = 0;              // of the curriculum
  int iterations = 0, moves = 0;  // at the present difficulty; that were seen to set a new best
  for (int i = 0; i < 20; ++i) {
    const TaskDifficulty now = run.trainer.state().curriculum.difficulty;
    const double present = now.goal_angle / now.velocity_tolerance + now.gravity_factor;
    iterations = present == before ? iterations + 1 : 1;
    before = present;
    run.Iterate(1);
    if (iterations < 3) {
      EXPECT_FALSE(run.trainer.improved()) << i;
      continue;
    }
    const RunScore& best = run.trainer.state().best;
    EXPECT_EQ(best.progress, present) << i;
    if (iterations == 3) {
      EXPECT_TRUE(run.trainer.improved()) << i;
      EXPECT_GT(best.progress, progress) << i;
      ++moves;
    }
    progress = best.progress;
  }
  EXPECT_GE(moves, 3);  // the curriculum moves where a goal was reached
}

TEST(RunFiles, SnapshotsAreTheFirstStatesPastEveryMultipleAndResumedRunsAddNoOthers) {
  const TemporaryFolder folder("snapshots");
  {
    ToyRun first(ToyBase());
    RunFiles files = FilesOf(folder / "run", first);
    IterateAndSave(first, files, 4);
  }
  ToyRun second(ReadCheckpoint(folder / "run.h5"));
  RunFiles files = FilesOf(folder / "run", second);
  IterateAndSave(second, files, 4);
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder / "run.snapshots"))
    names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  // 1920 samples an iteration: the multiples of 5000 are passed in the third, sixth and eighth.
  EXPECT_EQ(names, (std::vector<std::string>{"000000005760.h5", "000000011520.h5",
                                             "000000015360.h5"}));
  EXPECT_EQ(ReadCheckpoint(folder / "run.snapshots/000000011520.h5").curve.size(), 6u);
}

TEST(RunFiles, AKillBetweenBestAndLastLeavesFilesThatAResumedRunMakesEqual) {
  const TemporaryFolder folder("between");
  ToyRun whole(ToyBase());
  RunFiles whole_files = FilesOf(folder / "whole", whole);
  IterateAndSave(whole, whole_files, 12);
  {
    ToyRun first(ToyBase());
    RunFiles files = FilesOf(folder / "cut", first);
    IterateAndSave(first, files, 4);
    fs::copy_file(folder / "cut.h5", folder / "last.h5");
    IterateAndSave(first, files, 4);
  }
  fs::rename(folder / "last.h5", folder / "cut.h5");  // the best file is now ahead
  ToyRun second(ReadCheckpoint(folder / "cut.h5"));
  RunFiles files = FilesOf(folder / "cut", second);
  IterateAndSave(second, files, 8);
  EXPECT_EQ(ReadFile(folder / "whole.h5"), ReadFile(folder / "cut.h5"));
  EXPECT_EQ(ReadFile(folder / "whole.best.h5"), ReadFile(folder / "cut.best.h5"));
}

}  // namespace
}  // namespace dexremoe
