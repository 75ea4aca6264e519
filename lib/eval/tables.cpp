#include "eval/tables.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "base/error.h"
#include "io/csv.h"

namespace dexremoe {
namespace {

// NOTE(paper): its table says 0.4 rad, its text 0.1 rad; the numbers are put beside our 0.4.
constexpr double kPaperTolerance = 0.4;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

using Columns = std::vector<TableColumn>;

Columns MetricColumns() {
  Columns columns;
  for (const Metric metric : {Metric::kMin, Metric::kMax, Metric::kWorst5, Metric::kBest5,
                              Metric::kMean, Metric::kPer600, Metric::kFallShare, Metric::kLength})
    columns.push_back({metric, {}});
  return columns;
}

// The categories of a split's objects, in alphabetical order, and all of them.
Columns CategoryColumns(const EvalFile& eval, const std::string& split) {
  std::set<std::string> categories;
  for (const EvalObject& object : eval.objects)
    if (object.split == split) categories.insert(object.category);
  Columns columns;
  for (const std::string& category : categories) columns.push_back({Metric::kMean, category});
  columns.push_back({});
  return columns;
}

std::vector<std::string> ObjectNames(const EvalFile& eval, const std::string& split) {
  std::vector<std::string> names;
  for (const EvalObject& object : eval.objects)
    if (object.split == split) names.push_back(object.name);
  return names;
}

// The episodes of all seeds of a method. Objects must be the same, in the same order.
std::vector<EpisodeRecord> PooledEpisodes(const MethodResults& method, const std::string& split,
                                          double tolerance) {
  std::vector<EpisodeRecord> all;
  for (const EvalFile& eval : method.evals) {
    const EvalRun* run = FindRun(eval, tolerance);
    if (run == nullptr) continue;
    const auto episodes = EpisodesOfSplit(eval, *run, split);
    all.insert(all.end(), episodes.begin(), episodes.end());
  }
  return all;
}

// The first method that was evaluated.
const MethodResults& FirstFound(const std::vector<MethodResults>& methods) {
  const auto found = std::find_if(methods.begin(), methods.end(),
                                  [](const MethodResults& m) { return !m.evals.empty(); });
  if (found == methods.end())
    Fail("expected an evaluation of at least one of {} methods, found none", methods.size());
  return *found;
}

// Tables compare methods only when all were evaluated alike.
void CheckComparable(const std::vector<MethodResults>& methods, bool rows_are_engines) {
  const MethodResults& reference = FirstFound(methods);
  const EvalFile& first = reference.evals.front();
  for (const MethodResults& method : methods)
    for (const EvalFile& eval : method.evals) {
      for (const char* split : {"train", "ood"})
        if (ObjectNames(eval, split) != ObjectNames(first, split))
          Fail("{}: expected the same {} objects as {}, found others", method.label, split,
               reference.label);
      const bool same = eval.engine == first.engine && eval.substeps == first.substeps;
      if ((!same && !rows_are_engines) || eval.push != first.push)
        Fail(
            "{}: expected engine {} with {} substeps and {} N pushes as for {}, found {}, {}, {} N",
            method.label, first.engine, first.substeps, first.push, reference.label, eval.engine,
            eval.substeps, eval.push);
    }
}

std::string SplitName(const std::string& split) {
  return split == "train" ? "training objects" : "out-of-distribution objects";
}

std::string Caption(const std::vector<MethodResults>& methods, const std::string& split,
                    double tolerance, const TableOptions& options) {
  const EvalFile& first = FirstFound(methods).evals.front();
  std::set<std::size_t> counts, seeds;
  std::vector<std::string> engines;  // of every method, or once where they are the same
  for (const MethodResults& method : methods) {
    if (method.evals.empty()) continue;
    counts.insert(PooledEpisodes(method, split, tolerance).size());
    seeds.insert(method.evals.size());
    const EvalFile& eval = method.evals.front();
    const std::string engine = fmt::format("{} with {} substeps", eval.engine, eval.substeps);
    if (std::find(engines.begin(), engines.end(), engine) == engines.end())
      engines.push_back(engine);
  }
  const std::string push =
      first.push > 0 ? fmt::format(", pushes of {} N", first.push) : std::string();
  return fmt::format(
      "Successes per episode on {} {}, tolerance {} rad; {} episodes a method, {} seed{}; engine "
      "{}{}; mean with 95 % interval (bootstrap over episodes).{}",
      ObjectNames(first, split).size(), SplitName(split), tolerance, fmt::join(counts, " or "),
      fmt::join(seeds, " or "), seeds == std::set<std::size_t>{1} ? "" : "s",
      fmt::join(engines, ", "), push,
      options.categories ? "" : " Falls: share of episodes; length: control steps of 600.");
}

std::vector<Estimate> Unknown(const Columns& columns) {
  return std::vector<Estimate>(columns.size(), {kUnknown, kUnknown, kUnknown});
}

// Those on objects of the category; all without one.
std::vector<EpisodeRecord> OfCategory(std::vector<EpisodeRecord> episodes,
                                      const std::vector<EvalObject>& objects,
                                      const std::string& category) {
  if (!category.empty())
    std::erase_if(episodes, [&](const EpisodeRecord& episode) {
      return objects[episode.object].category != category;
    });
  return episodes;
}

TableRow RowOf(const MethodResults& method, const std::string& split, double tolerance,
               const Columns& columns, const BootstrapOptions& bootstrap) {
  const auto episodes = PooledEpisodes(method, split, tolerance);
  if (episodes.empty()) return {method.label, false, Unknown(columns), true};
  const std::vector<EvalObject>& objects = method.evals.front().objects;
  std::map<std::string, Metrics> metrics;  // of each category that a column asks for
  TableRow row{method.label, false, {}};
  for (const auto& [metric, category] : columns) {
    if (!metrics.contains(category))
      metrics[category] = ComputeMetrics(OfCategory(episodes, objects, category), bootstrap);
    row.values.push_back(metrics[category][metric]);
  }
  return row;
}

std::vector<TableRow> PaperRows(const std::vector<PaperNumber>& paper, const std::string& table,
                                const std::string& split, const Columns& columns) {
  std::vector<TableRow> rows;
  for (const PaperNumber& number : paper) {
    if (number.table != table || number.split != split) continue;
    auto row = std::find_if(rows.begin(), rows.end(),
                            [&](const TableRow& r) { return r.label == number.method; });
    if (row == rows.end()) {
      rows.push_back({number.method, true, Unknown(columns)});
      row = rows.end() - 1;
    }
    for (std::size_t c = 0; c < columns.size(); ++c)
      if (number.metric == columns[c].name()) row->values[c] = {number.value, kUnknown, kUnknown};
  }
  return rows;
}

}  // namespace

std::string TableColumn::name() const {
  return category.empty() ? Info(metric).name : fmt::format("{}:{}", Info(metric).name, category);
}
std::string TableColumn::label() const { return category.empty() ? Info(metric).label : category; }

std::vector<PaperNumber> ReadPaperNumbers(const std::string& path) {
  const CsvTable csv = CsvTable::Read(path);
  const auto table = csv.Text("table"), method = csv.Text("method"), split = csv.Text("split"),
             metric = csv.Text("metric");
  const auto value = csv.Numbers("value");
  std::vector<PaperNumber> numbers;
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (split[i] != "train" && split[i] != "ood")
      Fail("{}: row {}: split: expected train or ood, found '{}'", path, i + 1, split[i]);
    bool known = false;
    for (int k = 0; k < kNumMetrics; ++k) known |= metric[i] == Info(static_cast<Metric>(k)).name;
    if (!known) Fail("{}: row {}: metric: found the unknown '{}'", path, i + 1, metric[i]);
    numbers.push_back({table[i], method[i], split[i], metric[i], value[i]});
  }
  return numbers;
}

std::vector<ResultTable> MakeTables(const std::vector<MethodResults>& methods,
                                    const std::vector<PaperNumber>& paper,
                                    const TableOptions& options,
                                    const BootstrapOptions& bootstrap) {
  CheckComparable(methods, options.engines);
  const EvalFile& first = FirstFound(methods).evals.front();
  std::vector<ResultTable> tables;
  for (const char* split : {"train", "ood"})
    for (const EvalRun& run : first.runs) {
      const double tolerance = run.tolerance;
      const Columns columns = options.categories ? CategoryColumns(first, split) : MetricColumns();
      ResultTable table{split, tolerance, columns, {}, Caption(methods, split, tolerance, options)};
      for (const MethodResults& method : methods)
        table.rows.push_back(RowOf(method, split, tolerance, columns, bootstrap));
      if (std::all_of(table.rows.begin(), table.rows.end(),
                      [](const TableRow& row) { return row.missing; }))
        continue;
      if (std::abs(tolerance - kPaperTolerance) < 1e-9)
        for (TableRow& row : PaperRows(paper, options.paper_table, split, columns))
          table.rows.push_back(std::move(row));
      tables.push_back(std::move(table));
    }
  return tables;
}

std::string ObjectCsvOf(const std::vector<MethodResults>& methods,
                        const BootstrapOptions& bootstrap) {
  std::vector<std::string> columns = {"object",    "category", "split",
                                      "tolerance", "method",   "episodes"};
  for (int k = 0; k < kNumObjectMetrics; ++k) {
    const std::string name = Info(static_cast<ObjectMetric>(k)).name;
    for (const char* suffix : {"", "_low", "_high"}) columns.push_back(name + suffix);
  }
  CsvWriter csv(columns);
  for (const MethodResults& method : methods) {
    if (method.evals.empty()) continue;
    const EvalFile& first = method.evals.front();
    for (const EvalRun& run : first.runs) {
      const auto episodes = PooledEpisodes(method, "all", run.tolerance);
      for (const ObjectMetrics& m : ComputeMetrics(episodes, bootstrap).objects) {
        const EvalObject& object = first.objects[m.object];
        std::vector<std::string> row = {object.name,  object.category,
                                        object.split, fmt::format("{}", run.tolerance),
                                        method.label, fmt::format("{}", m.episodes)};
        for (const Estimate& e : m.values)
          for (const double x : {e.value, e.low, e.high}) row.push_back(fmt::format("{:.6g}", x));
        csv.Row(row);
      }
    }
  }
  return csv.text();
}

}  // namespace dexremoe
