#include "eval/learn_bench_limit.h"

#include <spdlog/fmt/fmt.h>

namespace dexremoe {

double OperationsPerSample(double forward, const PpoOptions& ppo) {
  return forward * (1 + 1.0 / ppo.horizon + 3.0 * ppo.mini_epochs);
}

double LearnLimit::OfCore(double core_peak) const {
  const double rest = workers * (1 / rate - operations / peak);  // s per sample on one core
  return 1 / (operations / core_peak + rest);
}

std::string LimitText(const LearnLimit& limit) {
  return fmt::format(
      "In {}, {} environments x {} mini-epochs take {:.2f} MFLOP a sample, rollout and update; the "
      "peak of {:.0f} GFLOP/s would allow {:.1f} thousand samples/s; {:.1f} thousand are reached, "
      "{:.0f} %.\n",
      limit.ppo.precision, limit.ppo.envs, limit.ppo.mini_epochs, limit.operations / 1e6,
      limit.peak / 1e9, limit.AtPeak() / 1e3, limit.rate / 1e3, 100 * limit.rate / limit.AtPeak());
}

std::string OtherCoreText(const LearnLimit& limit, const std::vector<double>& core_peaks) {
  std::string text = fmt::format(
      "Arithmetic, not measurement: one core that multiplies bfloat16 in AMX tiles would be "
      "limited "
      "({} environments x {} mini-epochs; in brackets, if all that is not products took as long as "
      "it does here in {}) to",
      limit.ppo.envs, limit.ppo.mini_epochs, limit.ppo.precision);
  for (std::size_t i = 0; i < core_peaks.size(); ++i)
    text += fmt::format("{} {:.0f} ({:.0f}) thousand samples/s at {:.0f} GFLOP/s", i > 0 ? "," : "",
                        limit.OfCoreAtMost(core_peaks[i]) / 1e3, limit.OfCore(core_peaks[i]) / 1e3,
                        core_peaks[i] / 1e9);
  return text + ".\n";
}

}  // namespace dexremoe
