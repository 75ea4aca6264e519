#include "rl/run_files.h"

#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "io/atomic_file.h"
#include "rl/checkpoint.h"

namespace dexremoe {

std::string RangesPath(const std::string& curve) {
  return std::filesystem::path(curve).replace_extension(".ranges.csv");
}

namespace {

std::vector<std::pair<std::string, double>> RangesOf(const AdrState& adr) {
  std::vector<std::pair<std::string, double>> scalars;
  for (std::size_t i = 0; i < adr.low.size(); ++i)
    for (const bool high : {false, true})
      scalars.emplace_back(
          std::string("adr/") + kRandomParameters[i].name + (high ? "_high" : "_low"),
          high ? adr.high[i] : adr.low[i]);
  return scalars;
}

}  // namespace

RunFiles::RunFiles(RunPaths paths, Provenance provenance, const RunPeriods& periods,
                   const TrainState& start)
    : paths_(std::move(paths)),
      provenance_(std::move(provenance)),
      periods_(periods),
      curve_(paths_.curve, start.curve),
      events_(paths_.tensorboard, start.samples),
      last_(Clock::now()) {
  std::error_code ignored;
  if (start.best == RunScore()) std::filesystem::remove(paths_.best, ignored);
}

void RunFiles::Add(const Trainer& trainer, double samples) {
  const CurveRow& row = trainer.state().curve.back();
  curve_.Add(row, trainer.time(), samples);
  events_.Add(row, trainer.time(), samples, RangesOf(trainer.state().adr));
  if (trainer.improved()) best_ = trainer.state();
  const auto count = [&](double s) { return std::floor(s / periods_.snapshot_samples); };
  const double now = static_cast<double>(trainer.state().samples);
  if (!paths_.snapshots.empty() && count(now) > count(now - samples))
    WriteSnapshot(trainer.state());
}

void RunFiles::WriteSnapshot(const TrainState& state) const {
  std::filesystem::create_directories(paths_.snapshots);
  WriteCheckpoint(fmt::format("{}/{:012d}.h5", paths_.snapshots, state.samples), state,
                  provenance_);
}

bool RunFiles::Due() const {
  return std::chrono::duration<double>(Clock::now() - last_).count() >
         60 * periods_.checkpoint_minutes;
}

void RunFiles::Save(const TrainState& last) {
  if (best_) WriteCheckpoint(paths_.best, *best_, provenance_);
  best_.reset();
  WriteCheckpoint(paths_.out, last, provenance_);
  curve_.Write();
  if (!last.adr.empty() && !paths_.curve.empty())
    WriteFile(RangesPath(paths_.curve), AdrCsv(last.adr));
  last_ = Clock::now();
}

}  // namespace dexremoe
