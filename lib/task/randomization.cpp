#include "task/randomization.h"

#include "base/error.h"

namespace dexremoe {

RandomOptions::RandomOptions() {
  for (int i = 0; i < kNumRandom; ++i)
    range[i] = {kRandomParameters[i].low, kRandomParameters[i].high};
}

void RandomOptions::Register(Options& options) {
  options.Add("random.on", &on, "randomise episodes (domain randomisation; for training)");
  for (int i = 0; i < kNumRandom; ++i)
    options.Add(
        std::string("random.") + kRandomParameters[i].name, &range[i],
        std::string(kRandomParameters[i].help) + ": low,high" +
            (kRandomParameters[i].spread == Distribution::kLogUniform ? ", log-uniform" : ""));
}

void RandomOptions::Check() const {
  for (int i = 0; i < kNumRandom; ++i) {
    const RandomParameter& p = kRandomParameters[i];
    const double least = p.spread == Distribution::kLogUniform || i <= kFriction ? 1e-9 : 0;
    const std::vector<double>& r = range[i];
    if (r.size() != 2 || !(r[0] <= r[1]) || !(r[0] >= least))
      throw UsageError(fmt::format("random.{}: expected low,high with {} <= low <= high, found {}",
                                   p.name, least, fmt::join(r, ",")));
  }
}

}  // namespace dexremoe
