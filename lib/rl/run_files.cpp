#include "rl/run_files.h"

#include <filesystem>

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

RunFiles::RunFiles(RunPaths paths, Provenance provenance, double checkpoint_minutes,
                   const TrainState& start)
    : paths_(std::move(paths)),
      provenance_(std::move(provenance)),
      period_(60 * checkpoint_minutes),
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
}

bool RunFiles::Due() const { return Clock::now() - last_ > period_; }

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
