#include "eval/eval_file.h"

#include <cmath>

#include "base/error.h"

namespace dexremoe {
namespace {

// One column over the episodes of all runs; `value` maps (run index, episode) to an element.
template <typename T, typename Value>
void WriteColumn(H5Writer& file, const EvalFile& eval, const std::string& name, const char* unit,
                 const char* doc, Value value) {
  std::vector<T> column;
  for (std::size_t r = 0; r < eval.runs.size(); ++r)
    for (const EpisodeRecord& e : eval.runs[r].episodes)
      column.push_back(static_cast<T>(value(r, e)));
  const auto count = static_cast<std::int64_t>(column.size());
  file.Write("episode/" + name, column, {count}, {unit, "episode", doc});
}

void WriteEpisodes(H5Writer& file, const EvalFile& eval) {
  using E = EpisodeRecord;
  const auto run = [](std::size_t r, const E&) { return r; };
  WriteColumn<std::int32_t>(file, eval, "run", "1", "index into run/tolerance", run);
  WriteColumn<std::int32_t>(file, eval, "object", "1", "index into object/name",
                            [](std::size_t, const E& e) { return e.object; });
  WriteColumn<std::uint64_t>(file, eval, "number", "1", "addresses the random streams",
                             [](std::size_t, const E& e) { return e.episode; });
  WriteColumn<std::int32_t>(file, eval, "length", "step", "control steps lived",
                            [](std::size_t, const E& e) { return e.length; });
  WriteColumn<std::int32_t>(file, eval, "successes", "1", "goals reached",
                            [](std::size_t, const E& e) { return e.successes; });
  WriteColumn<std::uint8_t>(file, eval, "end", "1", "1 fall, 2 timeout",
                            [](std::size_t, const E& e) { return e.end; });
  if (eval.jams_known)
    WriteColumn<std::int32_t>(file, eval, "still", "step",
                              "control steps up to the end without turning while two tips pressed; "
                              "a timeout with more than 60 is a jam (lib/eval/outcome.h)",
                              [](std::size_t, const E& e) { return e.still; });
  WriteColumn<double>(file, eval, "reward", "1", "sum of scaled rewards",
                      [](std::size_t, const E& e) { return e.total_reward; });
  WriteColumn<double>(file, eval, "angle", "rad", "mean rotation distance to the goal",
                      [](std::size_t, const E& e) { return e.mean_angle; });
  WriteColumn<double>(file, eval, "distance", "m", "mean distance from the grasp centre",
                      [](std::size_t, const E& e) { return e.mean_distance; });
}

// value, low and high of a list of estimates under GROUP/value and so on.
void WriteEstimates(H5Writer& file, const std::string& group, const std::vector<Estimate>& all,
                    const std::vector<std::int64_t>& extents, const char* dims) {
  std::vector<double> value, low, high;
  for (const Estimate& e : all) {
    value.push_back(e.value);
    low.push_back(e.low);
    high.push_back(e.high);
  }
  file.Write(group + "/value", value, extents, {"see name", dims, "figure from all episodes"});
  file.Write(group + "/low", low, extents, {"see name", dims, "95 % interval, bootstrap, lower"});
  file.Write(group + "/high", high, extents, {"see name", dims, "95 % interval, bootstrap, upper"});
}

void WriteMetrics(H5Writer& file, const EvalFile& eval) {
  std::vector<std::string> names, object_names;
  for (int k = 0; k < kNumMetrics; ++k) names.push_back(Info(static_cast<Metric>(k)).name);
  for (int k = 0; k < kNumObjectMetrics; ++k)
    object_names.push_back(Info(static_cast<ObjectMetric>(k)).name);
  std::vector<Estimate> all, object;
  for (const EvalRun& run : eval.runs) {
    all.insert(all.end(), run.metrics.values.begin(), run.metrics.values.end());
    for (const ObjectMetrics& m : run.metrics.objects)
      object.insert(object.end(), m.values.begin(), m.values.end());
  }
  const auto runs = static_cast<std::int64_t>(eval.runs.size());
  const auto objects = static_cast<std::int64_t>(eval.objects.size());
  file.WriteStrings("metric/name", names, {"", "metric", "see lib/eval/metrics.h"});
  WriteEstimates(file, "metric", all, {runs, kNumMetrics}, "run, metric");
  file.WriteStrings("object_metric/name", object_names, {"", "metric", "see lib/eval/metrics.h"});
  WriteEstimates(file, "object_metric", object, {runs, objects, kNumObjectMetrics},
                 "run, object, metric");
}

std::vector<Estimate> ReadEstimates(const H5Reader& file, const std::string& group,
                                    const std::vector<std::int64_t>& extents) {
  const auto value = file.ReadValues<double>(group + "/value", extents);
  const auto low = file.ReadValues<double>(group + "/low", extents);
  const auto high = file.ReadValues<double>(group + "/high", extents);
  std::vector<Estimate> all(value.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = {value[i], low[i], high[i]};
  return all;
}

void ReadEpisodes(const H5Reader& file, EvalFile& eval) {
  const auto run = file.ReadValues<std::int32_t>("episode/run", {-1});
  const std::vector<std::int64_t> extents = {static_cast<std::int64_t>(run.size())};
  const auto object = file.ReadValues<std::int32_t>("episode/object", extents);
  const auto number = file.ReadValues<std::uint64_t>("episode/number", extents);
  const auto length = file.ReadValues<std::int32_t>("episode/length", extents);
  const auto successes = file.ReadValues<std::int32_t>("episode/successes", extents);
  const auto end = file.ReadValues<std::uint8_t>("episode/end", extents);
  eval.jams_known = file.Has("episode/still");
  const auto still = eval.jams_known ? file.ReadValues<std::int32_t>("episode/still", extents)
                                     : std::vector<std::int32_t>(run.size(), -1);
  const auto reward = file.ReadValues<double>("episode/reward", extents);
  const auto angle = file.ReadValues<double>("episode/angle", extents);
  const auto distance = file.ReadValues<double>("episode/distance", extents);
  for (std::size_t i = 0; i < run.size(); ++i) {
    if (run[i] < 0 || run[i] >= static_cast<int>(eval.runs.size()) || object[i] < 0 ||
        object[i] >= static_cast<int>(eval.objects.size()))
      Fail("{}: dataset 'episode/run' or 'episode/object': row {} points outside", file.path(), i);
    EpisodeRecord e;
    e.object = object[i];
    e.episode = number[i];
    e.length = length[i];
    e.successes = successes[i];
    e.end = static_cast<EpisodeEnd>(end[i]);
    e.still = still[i];
    e.total_reward = reward[i];
    e.mean_angle = angle[i];
    e.mean_distance = distance[i];
    eval.runs[run[i]].episodes.push_back(e);
  }
}

void ReadMetrics(const H5Reader& file, EvalFile& eval) {
  const auto runs = static_cast<std::int64_t>(eval.runs.size());
  const auto objects = static_cast<std::int64_t>(eval.objects.size());
  const auto all = ReadEstimates(file, "metric", {runs, kNumMetrics});
  const auto each = ReadEstimates(file, "object_metric", {runs, objects, kNumObjectMetrics});
  for (std::int64_t r = 0; r < runs; ++r) {
    Metrics& metrics = eval.runs[r].metrics;
    std::copy_n(all.begin() + r * kNumMetrics, kNumMetrics, metrics.values.begin());
    for (std::int64_t o = 0; o < objects; ++o) {
      ObjectMetrics& m = metrics.objects.emplace_back();
      m.object = static_cast<int>(o);
      for (const EpisodeRecord& e : eval.runs[r].episodes) m.episodes += e.object == m.object;
      std::copy_n(each.begin() + (r * objects + o) * kNumObjectMetrics, kNumObjectMetrics,
                  m.values.begin());
    }
  }
}

}  // namespace

void WriteEval(const std::string& path, const EvalFile& eval, const Provenance& provenance) {
  H5Writer file(path, kEvalFormat, provenance);
  std::vector<std::string> name, category, split;
  for (const EvalObject& object : eval.objects) {
    name.push_back(object.name);
    category.push_back(object.category);
    split.push_back(object.split);
  }
  std::vector<double> tolerance;
  for (const EvalRun& run : eval.runs) tolerance.push_back(run.tolerance);
  file.WriteString("policy", eval.policy, {"", "", "policy file"});
  file.WriteScalar("samples", eval.samples, {"1", "", "that its training has seen"});
  file.WriteString("engine", eval.engine, {"", "", "simulation engine"});
  file.WriteScalar<std::int32_t>("substeps", eval.substeps,
                                 {"1", "", "physics steps per control step"});
  file.WriteScalar("seed", eval.seed, {"1", "", "seed of the run"});
  file.WriteScalar("push", eval.push, {"N", "", "size of the pushes on the object; 0 = none"});
  file.WriteString("category_input", eval.category_input,
                   {"", "", "what the policy was told of categories: label, predicted or soft"});
  file.WriteStrings("object/name", name, {"", "object", "name in objects.csv"});
  file.WriteStrings("object/category", category, {"", "object", "category"});
  file.WriteStrings("object/split", split, {"", "object", "train or ood"});
  file.Write("run/tolerance", tolerance, {static_cast<std::int64_t>(tolerance.size())},
             {"rad", "run", "success tolerance"});
  WriteEpisodes(file, eval);
  WriteMetrics(file, eval);
  file.Commit();
}

EvalFile ReadEval(const std::string& path) {
  const H5Reader file(path, kEvalFormat);
  EvalFile eval;
  eval.policy = file.ReadString("policy");
  eval.samples = file.ReadScalar<std::int64_t>("samples");
  eval.engine = file.ReadString("engine");
  eval.substeps = file.ReadScalar<std::int32_t>("substeps");
  eval.seed = file.ReadScalar<std::uint64_t>("seed");
  eval.push = file.ReadScalar<double>("push");
  if (file.Has("category_input")) eval.category_input = file.ReadString("category_input");
  const auto name = file.ReadStrings("object/name");
  const auto category = file.ReadStrings("object/category");
  const auto split = file.ReadStrings("object/split");
  if (category.size() != name.size() || split.size() != name.size())
    Fail("{}: datasets in 'object': expected equal extents, found {}, {}, {}", path, name.size(),
         category.size(), split.size());
  for (std::size_t i = 0; i < name.size(); ++i)
    eval.objects.push_back({name[i], category[i], split[i]});
  for (const double tolerance : file.ReadValues<double>("run/tolerance", {-1}))
    eval.runs.push_back({tolerance, {}, {}});
  ReadEpisodes(file, eval);
  ReadMetrics(file, eval);
  return eval;
}

const EvalRun* FindRun(const EvalFile& eval, double tolerance) {
  for (const EvalRun& run : eval.runs)
    if (std::abs(run.tolerance - tolerance) < 1e-9) return &run;
  return nullptr;
}

std::vector<EpisodeRecord> EpisodesOfSplit(const EvalFile& eval, const EvalRun& run,
                                           const std::string& split) {
  std::vector<EpisodeRecord> chosen;
  for (const EpisodeRecord& e : run.episodes)
    if (split == "all" || eval.objects[e.object].split == split) chosen.push_back(e);
  return chosen;
}

}  // namespace dexremoe
