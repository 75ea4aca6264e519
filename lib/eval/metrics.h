// What a set of evaluation episodes says: successes per object and the paper's five metrics, each
// with a 95 % interval.
//
// S_i is the number of successes of object i per episode (up to 600 control steps; a fall ends it),
// averaged over its episodes. S_min, S_max, the means of the five worst and of the five best
// objects and the mean over objects are the paper's metrics (paper, section IV-C, "Metrics"). With
// fewer than five objects the five worst and the five best are all of them.
//
// The minimum of noisy means is biased low, the maximum high (with 60 episodes the standard error
// of one S_i is near 0.8 at the paper's level), and so are the five worst and five best. The
// bootstrap resamples the noisy means once more and so shows the spread, not the bias: read S_min
// with its interval, and compare only figures made with the same number of episodes.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "task/reorient.h"

namespace dexremoe {

// A figure with its 95 % bootstrap percentile interval.
struct Estimate {
  double value = 0, low = 0, high = 0;
};

// Figures of one object or of all. The first block is per episode (a plain mean over episodes);
// kPer600 is successes * 600 / control steps lived, a rate that early falls do not lower. The two
// must not be mixed up.
enum class ObjectMetric {
  kSuccesses,
  kPer600,
  kFallShare,
  kTimeoutShare,
  kLength,
  kReturn,
  kAngle,
  kDistance
};
inline constexpr int kNumObjectMetrics = 8;

// The paper's five, then the other figures averaged over objects (kPer600: sums over all episodes).
enum class Metric {
  kMin,
  kMax,
  kWorst5,
  kBest5,
  kMean,
  kPer600,
  kFallShare,
  kTimeoutShare,
  kLength,
  kReturn,
  kAngle,
  kDistance
};
inline constexpr int kNumMetrics = 12;
inline constexpr int kNumPaperMetrics = 5;

struct MetricInfo {
  const char* name;   // key in files: "s_min"
  const char* label;  // for people: "S_min"
  const char* unit;
  const char* doc;
};
const MetricInfo& Info(Metric metric);
const MetricInfo& Info(ObjectMetric metric);

struct ObjectMetrics {
  int object = 0;  // the index that the episodes carry
  int episodes = 0;
  std::array<Estimate, kNumObjectMetrics> values;
  const Estimate& operator[](ObjectMetric m) const { return values[static_cast<int>(m)]; }
};

struct Metrics {
  std::array<Estimate, kNumMetrics> values;
  std::vector<ObjectMetrics> objects;  // in order of object index
  const Estimate& operator[](Metric m) const { return values[static_cast<int>(m)]; }
};

struct BootstrapOptions {
  int resamples = 2000;
  std::uint64_t seed = 0;
};

// `episodes` in any order, at least one. Episodes are resampled within each object (stratified);
// objects are fixed, so the intervals say how well these objects were measured, not how other
// objects would do. Results depend on the episodes' order within an object, not on anything else.
Metrics ComputeMetrics(const std::vector<EpisodeRecord>& episodes,
                       const BootstrapOptions& bootstrap);

// The p-quantile of `sorted` (ascending, not empty), linear between order statistics.
double Quantile(const std::vector<double>& sorted, double p);

}  // namespace dexremoe
