#include "rl/run_files.h"

#include <filesystem>

#include "rl/checkpoint.h"

namespace dexremoe {

std::string BestPath(const std::string& out) {
  return std::filesystem::path(out).replace_extension(".best.h5");
}

RunFiles::RunFiles(RunPaths paths, Provenance provenance, double checkpoint_minutes,
                   const TrainState& start)
    : paths_(std::move(paths)),
      provenance_(std::move(provenance)),
      period_(60 * checkpoint_minutes),
      curve_(paths_.curve, start.curve),
      events_(paths_.tensorboard, start.samples),
      last_(Clock::now()) {}

void RunFiles::Add(const Trainer& trainer, double samples) {
  const CurveRow& row = trainer.state().curve.back();
  curve_.Add(row, trainer.time(), samples);
  events_.Add(row, trainer.time(), samples);
  if (trainer.improved()) best_ = trainer.state();
}

bool RunFiles::Due() const { return Clock::now() - last_ > period_; }

void RunFiles::Save(const TrainState& last) {
  if (best_) WriteCheckpoint(BestPath(paths_.out), *best_, provenance_);
  best_.reset();
  WriteCheckpoint(paths_.out, last, provenance_);
  curve_.Write();
  last_ = Clock::now();
}

}  // namespace dexremoe
