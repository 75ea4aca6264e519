// What a peak rate of products allows learning at most: arithmetic on measured rates.
#pragma once

#include <string>
#include <vector>

#include "rl/ppo_options.h"

namespace dexremoe {

// Operations of an iteration per sample, of `forward` operations per row: the rollout's pass, with
// one more over the last states, and an update of three passes per mini-epoch.
double OperationsPerSample(double forward, const PpoOptions& ppo);

// A measured training beside the peak of the same turns.
struct LearnLimit {
  PpoOptions ppo;
  int workers = 1;
  double operations = 0;  // per sample
  double peak = 0;        // operations per second, all workers
  double rate = 0;        // samples per second, all workers

  // Samples per second if nothing but products took time, and these ran at the peak.
  double AtPeak() const { return peak / operations; }
  // Samples per second of one core with another peak: if nothing else took time; and if all else
  // took as long as it did here.
  double OfCoreAtMost(double core_peak) const { return core_peak / operations; }
  double OfCore(double core_peak) const;
};

// Sentences with the numbers of `limit`.
std::string LimitText(const LearnLimit& limit);
// The same for a core of other peaks (operations per second), as arithmetic on `limit`.
std::string OtherCoreText(const LearnLimit& limit, const std::vector<double>& core_peaks);

}  // namespace dexremoe
