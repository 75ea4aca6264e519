// The curriculum's rule: when it moves, what it moves, where it stops.
#include "rl/curriculum.h"

#include <gtest/gtest.h>

#include <numbers>

namespace dexremoe {
namespace {

PpoOptions Options() {
  PpoOptions o;
  o.curriculum = true;
  o.goal_angle_start = 1;
  o.goal_angle_factor = 1.5;
  o.velocity_start = 5;
  o.velocity_factor = 0.5;
  o.curriculum_threshold = 1.5;
  o.curriculum_period = 100;
  return o;
}

std::vector<EpisodeRecord> Episodes(std::vector<int> successes, int length = 600) {
  std::vector<EpisodeRecord> records;
  for (const int s : successes) {
    EpisodeRecord r;
    r.successes = s;
    r.length = length;
    records.push_back(r);
  }
  return records;
}

TEST(Curriculum, OffItIsTheTask) {
  PpoOptions options = Options();
  options.curriculum = false;
  const Curriculum curriculum(options, {2.5, 1.2});
  CurriculumState state = curriculum.Start();
  EXPECT_EQ(state.difficulty.goal_angle, 2.5);
  EXPECT_EQ(state.difficulty.velocity_tolerance, 1.2);
  EXPECT_FALSE(curriculum.Update(1000, Episodes({9, 9}), state));
}

TEST(Curriculum, MovesAngleAndVelocityInTurnUntilTheTask) {
  const Curriculum curriculum(Options(), {std::numbers::pi, 1});
  CurriculumState state = curriculum.Start();
  const double expected[][2] = {{1.5, 5},
                                {1.5, 2.5},
                                {2.25, 2.5},
                                {2.25, 1.25},
                                {std::numbers::pi, 1.25},
                                {std::numbers::pi, 1}};
  for (const auto& e : expected) {
    EXPECT_TRUE(curriculum.Update(100, Episodes({2}), state));
    EXPECT_DOUBLE_EQ(state.difficulty.goal_angle, e[0]);
    EXPECT_DOUBLE_EQ(state.difficulty.velocity_tolerance, e[1]);
  }
  EXPECT_FALSE(curriculum.Update(100, Episodes({5}), state));
}

TEST(Curriculum, GravityRisesWithEveryAdvanceUntilTheTasks) {
  PpoOptions options = Options();
  options.gravity_start = -0.5;
  options.gravity_step = 0.4;
  options.curriculum_objects = 1;
  const Curriculum curriculum(options, {1.5, 2.5}, 2);  // one advance away, each
  CurriculumState state = curriculum.Start();
  EXPECT_EQ(state.difficulty.gravity_factor, -0.5);
  for (const double gravity : {-0.1, 0.3, 0.7, 1.0}) {
    EXPECT_EQ(state.difficulty.objects, 1);  // they wait for gravity as well
    EXPECT_TRUE(curriculum.Update(100, Episodes({2}), state));
    EXPECT_DOUBLE_EQ(state.difficulty.gravity_factor, gravity);
  }
  EXPECT_TRUE(curriculum.Update(100, Episodes({2}), state));
  EXPECT_EQ(state.difficulty.objects, 2);
  EXPECT_FALSE(curriculum.Update(100, Episodes({9}), state));
}

TEST(Curriculum, HalfOfTheGoalsAreNearUntilGoalsAndSpeedsAreTheTasks) {
  PpoOptions options = Options();
  options.near_share_start = 0.5;
  const TaskDifficulty task = {.goal_angle = 1.5, .velocity_tolerance = 2.5, .near_share = 0.1};
  const Curriculum curriculum(options, task);  // one advance away, each
  CurriculumState state = curriculum.Start();
  for (int moves = 0; moves < 2; ++moves) {
    EXPECT_EQ(state.difficulty.near_share, 0.5);
    ASSERT_TRUE(curriculum.Update(100, Episodes({2}), state));
    curriculum.Complete(100, state.difficulty);
  }
  EXPECT_EQ(state.difficulty.near_share, 0.1);
}

TEST(Curriculum, TheShareOfNearGoalsIsTheTasksUnlessAskedFor) {
  for (const bool on : {false, true}) {
    PpoOptions options = Options();
    options.curriculum = on;
    if (!on) options.near_share_start = 0.5;  // nothing without a curriculum
    EXPECT_EQ(Curriculum(options, {.near_share = 0.2}).Start().difficulty.near_share, 0.2);
  }
}

TEST(Curriculum, FallsGetDearerLateInATrainingFromScratch) {
  PpoOptions options = Options();
  options.fall_share_start = 0.25;
  options.late_from = 0.2;
  options.span = 1000;
  TaskDifficulty now;
  for (const bool on : {false, true}) {
    options.curriculum = on;
    const Curriculum curriculum(options, {});
    EXPECT_EQ(curriculum.Start().difficulty.fall_share, 0.25);
    curriculum.Complete(200, now);
    EXPECT_EQ(now.fall_share, 0.25);
    curriculum.Complete(600, now);
    EXPECT_DOUBLE_EQ(now.fall_share, 0.625);
    curriculum.Complete(2000, now);
    EXPECT_EQ(now.fall_share, 1);
  }
}

TEST(Curriculum, FallsCostAllOfTheirPriceInAStageThatGoesOn) {
  PpoOptions options = Options();
  options.fall_share_start = 0.25;
  EXPECT_EQ(Curriculum(options, {}).Start().difficulty.fall_share, 1);
}

// A checkpoint has goals and speeds alone.
TEST(Curriculum, CompletesADifficultyFromGoalsAndSpeeds) {
  PpoOptions options = Options();
  options.near_share_start = 0.5;
  const Curriculum curriculum(options, {.goal_angle = 2, .near_share = 0.1});
  TaskDifficulty on_the_way = {.goal_angle = 1.5}, arrived = {.goal_angle = 2};
  curriculum.Complete(100, on_the_way);
  curriculum.Complete(100, arrived);
  EXPECT_EQ(on_the_way.near_share, 0.5);
  EXPECT_EQ(arrived.near_share, 0.1);
}

TEST(Curriculum, WaitsForThePeriodAndJudgesAllEpisodesInIt) {
  const Curriculum curriculum(Options(), {3.2, 1});
  CurriculumState state = curriculum.Start();
  EXPECT_FALSE(curriculum.Update(60, Episodes({4}), state));
  EXPECT_FALSE(curriculum.Update(60, Episodes({0, 0, 0}), state));  // mean 1
  EXPECT_FALSE(curriculum.Update(60, Episodes({4}), state));        // the new period is not over
  EXPECT_TRUE(curriculum.Update(60, Episodes({0, 1}), state));      // mean 5 / 3
  EXPECT_FALSE(curriculum.Update(200, {}, state));                  // no episode, no decision
}

// Many short episodes with few successes each must not count as progress.
TEST(Curriculum, FastDroppersDoNotPass) {
  const Curriculum curriculum(Options(), {3.2, 1});
  CurriculumState state = curriculum.Start();
  EXPECT_FALSE(curriculum.Update(100, Episodes(std::vector<int>(50, 1), 20), state));
}

TEST(Curriculum, ObjectsFollowOnceGoalsAndSpeedsAreTheTasks) {
  PpoOptions options = Options();
  options.curriculum_objects = 1;
  const Curriculum curriculum(options, {1, 5}, 5);  // goals and speeds are there already
  CurriculumState state = curriculum.Start();
  EXPECT_EQ(state.difficulty.objects, 1);
  EXPECT_FALSE(curriculum.Update(1000, Episodes({1}), state));  // too little success
  for (const int objects : {2, 4, 5}) {
    EXPECT_TRUE(curriculum.Update(100, Episodes({2}), state));
    EXPECT_EQ(state.difficulty.objects, objects);
  }
  EXPECT_FALSE(curriculum.Update(100, Episodes({9}), state));
  EXPECT_EQ(state.difficulty.objects, 5);
}

TEST(Curriculum, ObjectsWaitForGoalsAndSpeeds) {
  PpoOptions options = Options();
  options.curriculum_objects = 1;
  const Curriculum curriculum(options, {1.5, 1}, 5);
  CurriculumState state = curriculum.Start();
  while (state.difficulty.goal_angle < 1.5 || state.difficulty.velocity_tolerance > 1) {
    EXPECT_EQ(state.difficulty.objects, 1);
    ASSERT_TRUE(curriculum.Update(100, Episodes({2}), state));
  }
  EXPECT_EQ(state.difficulty.objects, 1);
  EXPECT_TRUE(curriculum.Update(100, Episodes({2}), state));
  EXPECT_EQ(state.difficulty.objects, 2);
}

}  // namespace
}  // namespace dexremoe
