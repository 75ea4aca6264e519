// A training that is ended at any moment and called again is the training that was never ended.
#include <gmock/gmock.h>

#include <chrono>
#include <thread>

#include "../io/event_reader.h"
#include "training_fixture.h"

namespace dexremoe {
namespace {

using testing::HasSubstr;

class KilledRun : public TrainingTest {
 protected:
  // The learning curve without its columns of wall-clock times.
  static std::vector<std::string> Rows(const std::string& name) {
    std::vector<std::string> rows;
    std::istringstream lines(Slurp(Path(name + ".csv")));
    for (std::string line; std::getline(lines, line);) {
      for (int column = 0; column < 3; ++column) line.erase(line.rfind(','));
      rows.push_back(line);
    }
    return rows;
  }
  static std::vector<std::int64_t> EventSteps(const std::string& name) {
    std::vector<std::int64_t> steps;
    for (const ReadEvent& event : EventReader::ReadFolder(Path("tensorboard/" + name)))
      if (!event.scalars.empty()) steps.push_back(event.step);
    return steps;
  }
  static void Sleep(int milliseconds) {
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
  }
  static void WaitForFile(const std::string& path) {
    for (int i = 0; i < 3000 && !std::filesystem::exists(path); ++i) Sleep(10);
    ASSERT_TRUE(std::filesystem::exists(path)) << path;
  }
};

TEST_F(KilledRun, KilledAgainAndAgainItEndsInTheBytesOfTheUninterruptedRun) {
  ASSERT_EQ(Run(TrainBase("whole"), "whole"), 0) << Slurp(Path("whole.txt"));
  // Saving after every iteration, it spends much of its time in writing checkpoints.
  const std::string line = TrainBase("cut", "--resume --checkpoint_minutes=0");
  int killed = 0;
  for (const int milliseconds : {0, 35, 90, 150}) {
    const pid_t child = Start(line, "cut");
    WaitForFile(Path("cut.h5"));
    Sleep(milliseconds);
    kill(child, SIGKILL);
    killed += Wait(child) == 128 + SIGKILL;
  }
  EXPECT_GT(killed, 0);
  EXPECT_NE(Slurp(Path("cut.h5")), Slurp(Path("whole.h5")));
  ASSERT_EQ(Run(line, "cut"), 0) << Slurp(Path("cut.txt"));
  EXPECT_EQ(Slurp(Path("cut.h5")), Slurp(Path("whole.h5")));
  EXPECT_EQ(Slurp(Path("cut.best.h5")), Slurp(Path("whole.best.h5")));
  EXPECT_FALSE(Slurp(Path("cut.best.h5")).empty());
  EXPECT_EQ(Rows("cut"), Rows("whole"));
  EXPECT_EQ(Rows("cut").size(), 1u + 80);
  EXPECT_EQ(EventSteps("cut"), EventSteps("whole"));
}

TEST_F(KilledRun, AStopSignalSavesSaysHowToGoOnAndExitsWith1) {
  for (const int signal : {SIGTERM, SIGINT}) {
    const std::string name = "stopped" + std::to_string(signal);
    const pid_t child = Start(TrainBase(name, "--samples=1e9 --checkpoint_minutes=0"), name);
    WaitForFile(Path(name + ".h5"));
    kill(child, signal);
    EXPECT_EQ(Wait(child), 1);
    EXPECT_THAT(Slurp(Path(name + ".txt")), HasSubstr("--resume"));
    EXPECT_THAT(Slurp(Path(name + ".txt")), HasSubstr(name + ".h5 is written"));
  }
}

TEST_F(KilledRun, ASecondProcessDoesNotWriteTheSameCheckpoint) {
  const std::string line = TrainBase("shared", "--samples=1e9 --resume --checkpoint_minutes=0");
  const pid_t first = Start(line, "first");
  WaitForFile(Path("shared.h5"));
  EXPECT_EQ(Run(line, "second"), 1);
  EXPECT_THAT(Slurp(Path("second.txt")), HasSubstr("shared.h5: another process is writing it"));
  kill(first, SIGKILL);
  Wait(first);
  const pid_t third = Start(line, "third");  // the dead one holds nothing
  std::filesystem::remove(Path("shared.csv"));
  WaitForFile(Path("shared.csv"));
  kill(third, SIGTERM);
  EXPECT_EQ(Wait(third), 1);
  EXPECT_FALSE(std::filesystem::exists(Path("shared.h5.lock")));
}

}  // namespace
}  // namespace dexremoe
