#include "eval/report.h"

#include <algorithm>

#include "base/error.h"
#include "eval/outcome.h"

namespace dexremoe {
namespace {

constexpr char kHeadLine[] =
    "{:<{}}  {:<8}  {:<5}  {:>4}  {:>20}  {:>7}  {:>5}  {:>5}  {:>6}  {:>7}  {:>6}  {:>5}\n";

std::string JamShare(const EvalFile& eval, const std::vector<EpisodeRecord>& episodes) {
  return eval.jams_known ? fmt::format("{:.2f}", SharesOf(episodes).jam) : "?";
}

// Of every object.
std::vector<std::string> JamShares(const EvalFile& eval, const EvalRun& run) {
  std::vector<std::vector<EpisodeRecord>> of(eval.objects.size());
  for (const EpisodeRecord& e : run.episodes) of[e.object].push_back(e);
  std::vector<std::string> shares;
  for (const auto& episodes : of) shares.push_back(JamShare(eval, episodes));
  return shares;
}

std::string ObjectLines(const EvalFile& eval, const EvalRun& run) {
  std::size_t width = 6;
  for (const EvalObject& object : eval.objects) width = std::max(width, object.name.size());
  const std::vector<std::string> jams = JamShares(eval, run);
  std::string text = fmt::format(kHeadLine, "object", width, "category", "split", "n", "S [95 %]",
                                 "per 600", "falls", "jams", "length", "return", "angle", "|dp|");
  text += fmt::format(kHeadLine, "", width, "", "", "", "", "", "", "", "steps", "", "rad", "cm");
  for (const ObjectMetrics& m : run.metrics.objects) {
    const EvalObject& object = eval.objects[m.object];
    const Estimate& s = m[ObjectMetric::kSuccesses];
    text += fmt::format(
        "{:<{}}  {:<8}  {:<5}  {:>4}  {:>20}  {:>7.2f}  {:>5.2f}  {:>5}  {:>6.0f}  {:>7.2f}  "
        "{:>6.2f}  "
        "{:>5.2f}\n",
        object.name, width, object.category, object.split, m.episodes,
        fmt::format("{:.2f} [{:.2f}, {:.2f}]", s.value, s.low, s.high),
        m[ObjectMetric::kPer600].value, m[ObjectMetric::kFallShare].value, jams[m.object],
        m[ObjectMetric::kLength].value, m[ObjectMetric::kReturn].value,
        m[ObjectMetric::kAngle].value, 100 * m[ObjectMetric::kDistance].value);
  }
  return text;
}

std::string MetricLines(const Metrics& metrics) {
  std::string text;
  for (int k = 0; k < kNumMetrics; ++k) {
    const Metric metric = static_cast<Metric>(k);
    const Estimate& e = metrics[metric];
    text += fmt::format(
        "{:<14} {:>10.4g}  [{:.4g}, {:.4g}]{}\n", Info(metric).label, e.value, e.low, e.high,
        std::string(Info(metric).unit) == "1" ? "" : fmt::format(" {}", Info(metric).unit));
  }
  return text;
}

}  // namespace

std::string ReportOf(const EvalFile& eval) {
  std::string text = fmt::format(
      "{}: engine {} with {} substeps, seed {}{}{}\n", eval.policy, eval.engine, eval.substeps,
      eval.seed, eval.push > 0 ? fmt::format(", pushes of {} N", eval.push) : std::string(),
      eval.category_input == "label" ? "" : ", categories " + eval.category_input);
  for (const EvalRun& run : eval.runs) {
    text += fmt::format("\ntolerance {} rad, {} episodes\n", run.tolerance, run.episodes.size());
    text += ObjectLines(eval, run) + "\n";
    text +=
        "all objects, with 95 % intervals (bootstrap over episodes)\n" + MetricLines(run.metrics);
    text += fmt::format("{:<14} {:>10}  of all episodes: jammed between fingers at their end\n",
                        "jams", JamShare(eval, run.episodes));
  }
  return text;
}

}  // namespace dexremoe
