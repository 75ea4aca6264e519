// How episodes end: in a fall, standing jammed when the time is up, or turning until then (paper,
// section IV-C: parts lodged between the fingers keep the object from turning).
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "task/reorient.h"

namespace dexremoe {

// A hand stands jammed when its object has not turned for longer than kJamSteps although at least
// kJamFingers tips pressed it all the while. Not turning means: within kJamAngle of one
// orientation. NOTE(paper): it gives neither number; 0.1 rad would miss trembling objects.
inline constexpr int kJamSteps = 60;      // control steps; a second at the paper's rate
inline constexpr int kJamFingers = 2;     // tips in contact
inline constexpr double kJamAngle = 0.2;  // rad; half the tolerance: trembling is not turning

// How long one object has not turned while fingers pressed it.
class StillClock {
 public:
  void Start(const Eigen::Quaterniond& q_WO);
  // `steps` control steps later: the orientation there, and which tips touch ([fingers], 0 or 1).
  void Advance(const Eigen::Quaterniond& q_WO, std::span<const std::uint8_t> tip_contact,
               int steps);
  int still() const { return still_; }  // control steps up to now

 private:
  Eigen::Quaterniond since_ = Eigen::Quaterniond::Identity();  // orientation when `still_` was 0
  int still_ = 0;
};

enum class Outcome { kFall, kJam, kTime };
inline constexpr int kNumOutcomes = 3;
const char* OutcomeName(Outcome outcome);  // "fall", "jam" or "time"

// A jam where the episode ran its time and stood jammed at the end. Records without `still` (-1)
// never count as jams.
Outcome OutcomeOf(const EpisodeRecord& episode);

// Shares of the episodes; they sum to one (to zero without episodes).
struct OutcomeShares {
  double fall = 0, jam = 0, time = 0;
};
OutcomeShares SharesOf(const std::vector<EpisodeRecord>& episodes);

}  // namespace dexremoe
