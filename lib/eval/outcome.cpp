#include "eval/outcome.h"

#include <algorithm>
#include <array>

#include "task/rotation.h"

namespace dexremoe {

void StillClock::Start(const Eigen::Quaterniond& q_WO) {
  since_ = q_WO;
  still_ = 0;
}

void StillClock::Advance(const Eigen::Quaterniond& q_WO, std::span<const std::uint8_t> tip_contact,
                         int steps) {
  const auto fingers =
      std::count_if(tip_contact.begin(), tip_contact.end(), [](std::uint8_t t) { return t != 0; });
  if (fingers < kJamFingers || RotationDistance(q_WO, since_) > kJamAngle)
    Start(q_WO);
  else
    still_ += steps;
}

const char* OutcomeName(Outcome outcome) {
  static constexpr std::array<const char*, kNumOutcomes> kNames = {"fall", "jam", "time"};
  return kNames[static_cast<std::size_t>(outcome)];
}

Outcome OutcomeOf(const EpisodeRecord& episode) {
  if (episode.end == EpisodeEnd::kFall) return Outcome::kFall;
  return episode.still > kJamSteps ? Outcome::kJam : Outcome::kTime;
}

OutcomeShares SharesOf(const std::vector<EpisodeRecord>& episodes) {
  std::array<double, kNumOutcomes> share{};
  for (const EpisodeRecord& e : episodes)
    share[static_cast<std::size_t>(OutcomeOf(e))] += 1.0 / static_cast<double>(episodes.size());
  return {share[0], share[1], share[2]};
}

}  // namespace dexremoe
