#include "rl/curve_events.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "../io/event_reader.h"
#include "fixture.h"

namespace dexremoe {
namespace {

using ::testing::ElementsAre;

std::vector<ReadEvent> ScalarEvents(const std::string& folder) {
  std::vector<ReadEvent> events = EventReader::ReadFolder(folder);
  std::erase_if(events, [](const ReadEvent& event) { return event.scalars.empty(); });
  return events;
}

TEST(CurveEvents, HoldTheCurveUnderTheTagsThatUsersKnow) {
  const TemporaryFolder folder("events");
  ToyRun run(ToyBase());
  CurveEvents events(folder / "base", 0);
  for (int i = 0; i < 2; ++i) events.Add(run.trainer.Iterate(), {2, 3}, 1920);
  const std::vector<ReadEvent> read = ScalarEvents(folder / "base");
  ASSERT_EQ(read.size(), 2u);
  const CurveRow& row = run.trainer.state().curve[1];
  EXPECT_EQ(read[1].step, static_cast<std::int64_t>(row[1]));
  EXPECT_GT(read[1].wall_time, 1.5e9);
  std::map<std::string, float> scalars = read[1].scalars;
  EXPECT_EQ(scalars["success/per_episode"], static_cast<float>(row[2]));
  EXPECT_EQ(scalars["return"], static_cast<float>(row[8]));
  EXPECT_EQ(scalars["fps/total"], 384.0f);
  EXPECT_EQ(scalars["fps/rollout"], 960.0f);
  EXPECT_EQ(scalars["fps/update"], 640.0f);
  for (const char* tag : {"success/per_600", "drop_rate", "episode_length", "angle", "dp",
                          "loss/policy", "loss/value", "kl", "lr", "clip_fraction", "log_std",
                          "explained_variance", "curriculum/goal_angle", "curriculum/velocity"})
    EXPECT_TRUE(read[1].scalars.contains(tag)) << tag;
}

TEST(CurveEvents, AResumedRunLeavesEachStepOnceWithTheResumedRunsValues) {
  const TemporaryFolder folder("events_resumed");
  ToyRun first(ToyBase());
  std::vector<std::int64_t> steps;
  {
    CurveEvents events(folder / "base", 0);
    for (int i = 0; i < 4; ++i) {
      events.Add(first.trainer.Iterate(), {1, 1}, 1);
      steps.push_back(first.trainer.state().samples);
    }
  }
  // Resumed at the second iteration; the rows carry another value, to be told apart.
  CurveEvents events(folder / "base", steps[1]);
  CurveRow third = first.trainer.state().curve[2];
  third[8] = 77;
  events.Add(third, {1, 1}, 1);
  std::vector<std::int64_t> read;
  for (const ReadEvent& event : ScalarEvents(folder / "base")) read.push_back(event.step);
  EXPECT_THAT(read, ElementsAre(steps[0], steps[1], steps[2]));
  EXPECT_EQ(ScalarEvents(folder / "base").back().scalars["return"], 77.0f);
}

}  // namespace
}  // namespace dexremoe
