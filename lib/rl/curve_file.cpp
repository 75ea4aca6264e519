#include "rl/curve_file.h"

#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "io/atomic_file.h"
#include "io/csv.h"

namespace dexremoe {
namespace {

constexpr const char* kTimeColumns[] = {"seconds", "rollout_rate", "update_rate"};

}  // namespace

CurveFile::CurveFile(std::string path, const std::vector<CurveRow>& rows)
    : path_(std::move(path)), rows_(rows), times_(rows.size(), {NAN, NAN, NAN}) {
  if (!path_.empty() && !rows_.empty() && std::filesystem::exists(path_)) ReadTimes();
}

void CurveFile::ReadTimes() {
  const CsvTable table = CsvTable::Read(path_);
  const auto seconds = table.Numbers(kTimeColumns[0]);
  const auto rollout = table.Numbers(kTimeColumns[1]);
  const auto update = table.Numbers(kTimeColumns[2]);
  for (std::size_t i = 0; i < std::min(rows_.size(), table.num_rows()); ++i)
    times_[i] = {seconds[i], rollout[i], update[i]};
}

void CurveFile::Add(const CurveRow& row, const IterationTime& time, double samples) {
  const double before =
      times_.empty() || !std::isfinite(times_.back().seconds) ? 0 : times_.back().seconds;
  rows_.push_back(row);
  times_.push_back(
      {before + time.rollout + time.update, samples / time.rollout, samples / time.update});
}

void CurveFile::Write() const {
  if (path_.empty()) return;
  std::vector<std::string> columns(kCurveColumns.begin(), kCurveColumns.end());
  columns.insert(columns.end(), std::begin(kTimeColumns), std::end(kTimeColumns));
  CsvWriter csv(columns);
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    std::vector<std::string> fields;
    for (const double value : rows_[i]) fields.push_back(fmt::format("{:.9g}", value));
    fields.push_back(fmt::format("{:.2f}", times_[i].seconds));
    fields.push_back(fmt::format("{:.0f}", times_[i].rollout_rate));
    fields.push_back(fmt::format("{:.0f}", times_[i].update_rate));
    csv.Row(fields);
  }
  WriteFile(path_, csv.text());
}

}  // namespace dexremoe
