#include "eval/metrics.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/check.h"
#include "base/error.h"
#include "base/random.h"

namespace dexremoe {
namespace {

constexpr double kWindow = 600;  // control steps; the paper's episode

// Sums over episodes of what the object metrics need: successes, falls, timeouts, steps, return,
// angle, distance.
constexpr int kNumSums = 7;
using Sums = std::array<double, kNumSums>;
using ObjectValues = std::array<double, kNumObjectMetrics>;
using Values = std::array<double, kNumMetrics>;

Sums SumsOf(const EpisodeRecord& e) {
  return {static_cast<double>(e.successes),
          e.end == EpisodeEnd::kFall ? 1.0 : 0.0,
          e.end == EpisodeEnd::kTimeout ? 1.0 : 0.0,
          static_cast<double>(e.length),
          e.total_reward,
          e.mean_angle,
          e.mean_distance};
}

Sums& operator+=(Sums& a, const Sums& b) {
  for (int k = 0; k < kNumSums; ++k) a[k] += b[k];
  return a;
}

double RatePer600(double successes, double steps) {
  return steps > 0 ? kWindow * successes / steps : 0;
}

ObjectValues ObjectValuesOf(const Sums& s, double episodes) {
  return {s[0] / episodes, RatePer600(s[0], s[3]), s[1] / episodes, s[2] / episodes,
          s[3] / episodes, s[4] / episodes,        s[5] / episodes, s[6] / episodes};
}

Values ValuesOf(const std::vector<ObjectValues>& objects, const Sums& total) {
  std::vector<double> s;
  for (const ObjectValues& object : objects) s.push_back(object[0]);
  std::sort(s.begin(), s.end());
  const auto n = static_cast<double>(s.size());
  const auto five = static_cast<std::ptrdiff_t>(std::min<std::size_t>(5, s.size()));
  const double share = static_cast<double>(five);
  Values v{};
  v[0] = s.front();
  v[1] = s.back();
  v[2] = std::accumulate(s.begin(), s.begin() + five, 0.0) / share;
  v[3] = std::accumulate(s.end() - five, s.end(), 0.0) / share;
  v[4] = std::accumulate(s.begin(), s.end(), 0.0) / n;
  v[5] = RatePer600(total[0], total[3]);
  for (int k = 2; k < kNumObjectMetrics; ++k) {
    double sum = 0;
    for (const ObjectValues& object : objects) sum += object[k];
    v[k + 4] = sum / n;
  }
  return v;
}

// Episodes grouped by object index, ascending.
std::map<int, std::vector<Sums>> GroupByObject(const std::vector<EpisodeRecord>& episodes) {
  std::map<int, std::vector<Sums>> groups;
  for (const EpisodeRecord& e : episodes) groups[e.object].push_back(SumsOf(e));
  return groups;
}

Estimate MakeEstimate(double value, std::vector<double>& draws) {
  if (draws.empty()) return {value, value, value};
  std::sort(draws.begin(), draws.end());
  return {value, Quantile(draws, 0.025), Quantile(draws, 0.975)};
}

// Draws of every metric, one vector per metric, filled resample by resample.
struct Draws {
  std::array<std::vector<double>, kNumMetrics> all;
  std::vector<std::array<std::vector<double>, kNumObjectMetrics>> object;
};

Draws Resample(const std::map<int, std::vector<Sums>>& groups, const BootstrapOptions& bootstrap) {
  Draws draws;
  draws.object.resize(groups.size());
  for (int b = 0; b < bootstrap.resamples; ++b) {
    std::vector<ObjectValues> objects;
    Sums total{};
    for (const auto& [object, episodes] : groups) {
      Rng rng(bootstrap.seed, Stream::kBootstrap,
              {static_cast<std::uint64_t>(b), static_cast<std::uint64_t>(object)});
      Sums sum{};
      for (std::size_t i = 0; i < episodes.size(); ++i) sum += episodes[rng.Index(episodes.size())];
      total += sum;
      auto& into = draws.object[objects.size()];
      objects.push_back(ObjectValuesOf(sum, static_cast<double>(episodes.size())));
      for (int k = 0; k < kNumObjectMetrics; ++k) into[k].push_back(objects.back()[k]);
    }
    const Values values = ValuesOf(objects, total);
    for (int k = 0; k < kNumMetrics; ++k) draws.all[k].push_back(values[k]);
  }
  return draws;
}

constexpr std::array<MetricInfo, kNumMetrics> kMetricInfo = {{
    {"s_min", "S_min", "1", "lowest S_i over objects"},
    {"s_max", "S_max", "1", "highest S_i over objects"},
    {"s_worst5", "S_5-", "1", "mean S_i of the five worst objects"},
    {"s_best5", "S_5+", "1", "mean S_i of the five best objects"},
    {"s_mean", "S_mean", "1", "mean S_i over objects"},
    {"per_600", "per 600 steps", "1", "successes per 600 control steps lived"},
    {"fall_share", "falls", "1", "share of episodes that end in a fall"},
    {"timeout_share", "timeouts", "1", "share of episodes that last to the end"},
    {"length", "length", "step", "mean episode length in control steps"},
    {"return", "return", "1", "mean sum of scaled rewards per episode"},
    {"angle", "angle", "rad", "mean rotation distance to the goal"},
    {"distance", "|dp|", "m", "mean distance of the object from the grasp centre"},
}};

}  // namespace

const MetricInfo& Info(Metric metric) { return kMetricInfo[static_cast<std::size_t>(metric)]; }

const MetricInfo& Info(ObjectMetric metric) {
  static constexpr MetricInfo kSuccesses = {"s", "S", "1", "successes per episode"};
  // After the first, the object metrics stand in the order of the last metrics of the whole.
  return metric == ObjectMetric::kSuccesses ? kSuccesses
                                            : kMetricInfo[static_cast<std::size_t>(metric) + 4];
}

double Quantile(const std::vector<double>& sorted, double p) {
  DEX_CHECK(!sorted.empty());
  const double position = p * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  if (below + 1 >= sorted.size()) return sorted.back();
  const double part = position - static_cast<double>(below);
  return sorted[below] + part * (sorted[below + 1] - sorted[below]);
}

Metrics ComputeMetrics(const std::vector<EpisodeRecord>& episodes,
                       const BootstrapOptions& bootstrap) {
  if (episodes.empty()) Fail("metrics: expected at least one episode, found none");
  const auto groups = GroupByObject(episodes);
  Draws draws = Resample(groups, bootstrap);
  Metrics metrics;
  std::vector<ObjectValues> objects;
  Sums total{};
  for (const auto& [object, list] : groups) {
    Sums sum{};
    for (const Sums& s : list) sum += s;
    total += sum;
    const std::size_t index = objects.size();
    objects.push_back(ObjectValuesOf(sum, static_cast<double>(list.size())));
    ObjectMetrics& m = metrics.objects.emplace_back();
    m.object = object;
    m.episodes = static_cast<int>(list.size());
    for (int k = 0; k < kNumObjectMetrics; ++k)
      m.values[k] = MakeEstimate(objects[index][k], draws.object[index][k]);
  }
  const Values values = ValuesOf(objects, total);
  for (int k = 0; k < kNumMetrics; ++k) metrics.values[k] = MakeEstimate(values[k], draws.all[k]);
  return metrics;
}

}  // namespace dexremoe
