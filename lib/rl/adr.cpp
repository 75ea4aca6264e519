#include "rl/adr.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/check.h"
#include "base/error.h"
#include "io/csv.h"

namespace dexremoe {
namespace {

void Remember(std::int64_t samples, AdrState& state) {
  std::vector<double> row = {static_cast<double>(samples)};
  for (int i = 0; i < kNumRandom; ++i) row.insert(row.end(), {state.low[i], state.high[i]});
  state.history.push_back(row);
}

// Outwards or inwards by the parameter's step, between its nominal value and its limit.
bool MoveBound(int bound, bool outwards, AdrState& state) {
  const RandomParameter& p = kRandomParameters[bound / 2];
  const bool upper = bound % 2 == 1;
  double& value = upper ? state.high[bound / 2] : state.low[bound / 2];
  const double before = value, step = upper == outwards ? p.step : -p.step;
  value = p.spread == Distribution::kLogUniform ? value * std::exp(step) : value + step;
  value = upper ? std::clamp(value, p.nominal, p.most) : std::clamp(value, p.least, p.nominal);
  return value != before;
}

}  // namespace

void AdrOptions::Register(Options& options) {
  options.Add("adr.queue", &queue, "boundary episodes per decision").Range(1, 1 << 20);
  options.Add("adr.low", &low, "successes per episode below which a range shrinks").Range(0, 600);
  options.Add("adr.high", &high, "successes per episode above which it widens").Range(0, 600);
  options.Add("adr.boundary_share", &boundary_share, "share of episodes at a bound").Range(0, 1);
}

void AdrOptions::Check() const {
  if (!(low <= high))
    throw UsageError(fmt::format("adr.low: expected at most adr.high = {}, found {}", high, low));
}

AdrState StartAdr() {
  AdrState state;
  for (const RandomParameter& p : kRandomParameters) {
    state.low.push_back(p.nominal);
    state.high.push_back(p.nominal);
  }
  state.queue.resize(2 * kNumRandom);
  Remember(0, state);
  return state;
}

bool UpdateAdr(const AdrOptions& options, const std::vector<EpisodeRecord>& records,
               std::int64_t samples, AdrState& state) {
  bool changed = false;
  for (const EpisodeRecord& record : records) {
    if (record.bound < 0) continue;
    DEX_CHECK_LT(record.bound, 2 * kNumRandom);
    std::vector<double>& queue = state.queue[record.bound];
    queue.push_back(record.successes);
    if (static_cast<int>(queue.size()) < options.queue) continue;
    const double mean =
        std::accumulate(queue.begin(), queue.end(), 0.0) / static_cast<double>(queue.size());
    queue.clear();
    if (mean > options.high) changed |= MoveBound(record.bound, true, state);
    if (mean < options.low) changed |= MoveBound(record.bound, false, state);
  }
  if (changed) Remember(samples, state);
  return changed;
}

std::vector<std::string> AdrColumns() {
  std::vector<std::string> columns = {"samples"};
  for (const RandomParameter& p : kRandomParameters)
    for (const char* side : {"_low", "_high"}) columns.push_back(std::string(p.name) + side);
  return columns;
}

std::string AdrCsv(const AdrState& state) {
  CsvWriter csv(AdrColumns());
  for (const std::vector<double>& row : state.history) {
    std::vector<std::string> fields;
    for (const double value : row) fields.push_back(fmt::format("{:.9g}", value));
    csv.Row(fields);
  }
  return csv.text();
}

}  // namespace dexremoe
