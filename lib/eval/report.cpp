#include "eval/report.h"

#include <algorithm>

#include "base/error.h"

namespace dexremoe {
namespace {

std::string ObjectLines(const EvalFile& eval, const EvalRun& run) {
  std::size_t width = 6;
  for (const EvalObject& object : eval.objects) width = std::max(width, object.name.size());
  std::string text =
      fmt::format("{:<{}}  {:<8}  {:<5}  {:>4}  {:>20}  {:>7}  {:>5}  {:>6}  {:>7}  {:>6}  {:>5}\n",
                  "object", width, "category", "split", "n", "S [95 %]", "per 600", "falls",
                  "length", "return", "angle", "|dp|");
  text +=
      fmt::format("{:<{}}  {:<8}  {:<5}  {:>4}  {:>20}  {:>7}  {:>5}  {:>6}  {:>7}  {:>6}  {:>5}\n",
                  "", width, "", "", "", "", "", "", "steps", "", "rad", "cm");
  for (const ObjectMetrics& m : run.metrics.objects) {
    const EvalObject& object = eval.objects[m.object];
    const Estimate& s = m[ObjectMetric::kSuccesses];
    text += fmt::format(
        "{:<{}}  {:<8}  {:<5}  {:>4}  {:>20}  {:>7.2f}  {:>5.2f}  {:>6.0f}  {:>7.2f}  {:>6.2f}  "
        "{:>5.2f}\n",
        object.name, width, object.category, object.split, m.episodes,
        fmt::format("{:.2f} [{:.2f}, {:.2f}]", s.value, s.low, s.high),
        m[ObjectMetric::kPer600].value, m[ObjectMetric::kFallShare].value,
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
  }
  return text;
}

}  // namespace dexremoe
