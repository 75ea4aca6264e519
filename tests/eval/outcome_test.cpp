// How episodes end, on made-up sequences.
#include "eval/outcome.h"

#include <gtest/gtest.h>

namespace dexremoe {
namespace {

constexpr std::uint8_t kNone[] = {0, 0, 0}, kOne[] = {0, 1, 0}, kTwo[] = {1, 0, 1};

Eigen::Quaterniond Turned(double angle) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
}

// `decisions` of three control steps; angle(k) and contact(k) after decision k.
template <typename Angle, typename Contact>
int StillAfter(int decisions, Angle angle, Contact contact) {
  StillClock clock;
  clock.Start(Turned(0));
  for (int k = 1; k <= decisions; ++k) clock.Advance(Turned(angle(k)), contact(k), 3);
  return clock.still();
}

const auto kAtRest = [](int) { return 0.0; };
const auto kHeld = [](int) { return std::span<const std::uint8_t>(kTwo); };

EpisodeRecord Ended(EpisodeEnd end, int still) {
  EpisodeRecord e;
  e.end = end;
  e.still = still;
  return e;
}

TEST(StillClock, CountsControlStepsOfAHeldObjectAtRest) {
  EXPECT_EQ(StillAfter(0, kAtRest, kHeld), 0);
  EXPECT_EQ(StillAfter(21, kAtRest, kHeld), 63);
}

TEST(StillClock, ATremblingObjectStandsStillAndASlowlyTurningOneDoesNot) {
  const auto trembling = [](int k) { return k % 2 == 0 ? 0.08 : -0.08; };
  const auto turning = [](int k) { return 0.015 * k; };  // 0.3 rad/s
  EXPECT_EQ(StillAfter(100, trembling, kHeld), 300);
  for (int k = 1; k <= 100; ++k) EXPECT_LE(StillAfter(k, turning, kHeld), kJamSteps);
}

TEST(StillClock, ATurnOrALostFingerStartsItAnew) {
  const auto jerk = [](int k) { return k >= 30 ? 0.3 : 0.0; };
  EXPECT_EQ(StillAfter(40, jerk, kHeld), 30);
  const auto slip = [](int k) { return std::span<const std::uint8_t>(k == 30 ? kOne : kTwo); };
  EXPECT_EQ(StillAfter(40, kAtRest, slip), 30);
}

TEST(StillClock, OneFingerOrNoneDoNotJam) {
  for (const auto& contact : {kOne, kNone})
    EXPECT_EQ(StillAfter(100, kAtRest, [&](int) { return std::span(contact, 3); }), 0);
}

TEST(Outcome, AJamIsAnEpisodeThatRanItsTimeAndStoodStillForOverASecond) {
  EXPECT_EQ(OutcomeOf(Ended(EpisodeEnd::kTimeout, kJamSteps)), Outcome::kTime);
  EXPECT_EQ(OutcomeOf(Ended(EpisodeEnd::kTimeout, kJamSteps + 1)), Outcome::kJam);
  EXPECT_EQ(OutcomeOf(Ended(EpisodeEnd::kFall, 300)), Outcome::kFall);
  EXPECT_EQ(OutcomeOf(Ended(EpisodeEnd::kTimeout, -1)), Outcome::kTime);  // nobody looked
}

TEST(Outcome, SharesSumToOne) {
  const OutcomeShares shares =
      SharesOf({Ended(EpisodeEnd::kFall, 0), Ended(EpisodeEnd::kTimeout, 90),
                Ended(EpisodeEnd::kTimeout, 0), Ended(EpisodeEnd::kFall, 90)});
  EXPECT_DOUBLE_EQ(shares.fall, 0.5);
  EXPECT_DOUBLE_EQ(shares.jam, 0.25);
  EXPECT_DOUBLE_EQ(shares.time, 0.25);
  EXPECT_EQ(SharesOf({}).fall, 0);
}

}  // namespace
}  // namespace dexremoe
