#include "eval/ranking.h"

#include <algorithm>

#include "base/error.h"
#include "io/csv.h"

namespace dexremoe {
namespace {

RankedObject Describe(const EvalFile& eval, const EvalRun& run, const ObjectMetrics& metrics) {
  const EvalObject& object = eval.objects[metrics.object];
  std::vector<EpisodeRecord> episodes;
  for (const EpisodeRecord& e : run.episodes)
    if (e.object == metrics.object) episodes.push_back(e);
  return {object.name,
          object.category,
          object.split,
          metrics.episodes,
          metrics[ObjectMetric::kSuccesses],
          SharesOf(episodes)};
}

std::string MarkdownRow(const Ranking& ranking, const RankedObject& o) {
  return fmt::format("| {} | {} | {} | {:.2f} [{:.2f}, {:.2f}] | {:.2f} | {} | {:.2f} |\n", o.name,
                     o.category, o.split, o.successes.value, o.successes.low, o.successes.high,
                     o.shares.fall, ranking.jams_known ? fmt::format("{:.2f}", o.shares.jam) : "?",
                     o.shares.time);
}

}  // namespace

Ranking RankObjects(const EvalFile& eval, const EvalRun& run, const std::string& split, int count) {
  std::vector<RankedObject> objects;
  for (const ObjectMetrics& metrics : run.metrics.objects)
    if (split == "all" || eval.objects[metrics.object].split == split)
      objects.push_back(Describe(eval, run, metrics));
  if (objects.size() < 2)
    Fail("{}: expected two objects of split {} or more, found {}", eval.policy, split,
         objects.size());
  std::sort(objects.begin(), objects.end(), [](const RankedObject& a, const RankedObject& b) {
    return a.successes.value != b.successes.value ? a.successes.value < b.successes.value
                                                  : a.name < b.name;
  });
  const std::size_t each = std::min(static_cast<std::size_t>(count), objects.size() / 2);
  Ranking ranking{eval.policy, eval.engine, run.tolerance, eval.jams_known, {}, {}};
  ranking.worst.assign(objects.begin(), objects.begin() + static_cast<std::ptrdiff_t>(each));
  ranking.best.assign(objects.rbegin(), objects.rbegin() + static_cast<std::ptrdiff_t>(each));
  return ranking;
}

std::string MarkdownOf(const Ranking& ranking) {
  std::string text = fmt::format(
      "{} on {}, tolerance {} rad. S: successes per episode with 95 % interval. How episodes end: "
      "in a fall; jammed (the object has not turned by {} rad for over a second while {} tips "
      "press "
      "it when the time is up); turning until then.\n\n",
      ranking.policy, ranking.engine, ranking.tolerance, kJamAngle, kJamFingers);
  text +=
      "| object | category | split | S | falls | jams | time |\n|:--|:--|:--|--:|--:|--:|--:|\n";
  text += "| **worst** | | | | | | |\n";
  for (const RankedObject& o : ranking.worst) text += MarkdownRow(ranking, o);
  text += "| **best** | | | | | | |\n";
  for (const RankedObject& o : ranking.best) text += MarkdownRow(ranking, o);
  return text;
}

std::string CsvOf(const Ranking& ranking) {
  CsvWriter csv({"group", "place", "object", "category", "split", "episodes", "s", "s_low",
                 "s_high", "falls", "jams", "time"});
  const auto add = [&](const char* group, const std::vector<RankedObject>& objects) {
    for (std::size_t i = 0; i < objects.size(); ++i) {
      const RankedObject& o = objects[i];
      std::vector<std::string> row = {group,   std::to_string(i + 1),     o.name, o.category,
                                      o.split, std::to_string(o.episodes)};
      for (const double x : {o.successes.value, o.successes.low, o.successes.high, o.shares.fall,
                             o.shares.jam, o.shares.time})
        row.push_back(fmt::format("{:.6g}", x));
      if (!ranking.jams_known) row[10] = "nan";
      csv.Row(row);
    }
  };
  add("worst", ranking.worst);
  add("best", ranking.best);
  return csv.text();
}

}  // namespace dexremoe
