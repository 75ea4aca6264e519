#include "rl/run_files.h"

#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "rl/checkpoint.h"

namespace dexremoe {

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
  events_.Add(row, trainer.time(), samples);
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
  last_ = Clock::now();
}

}  // namespace dexremoe
