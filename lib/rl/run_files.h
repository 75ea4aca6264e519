// What a training leaves behind as it goes: last and best checkpoint, states on the way, learning
// curve, events.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "io/h5.h"
#include "rl/curve_events.h"
#include "rl/curve_file.h"
#include "rl/train_state.h"
#include "rl/trainer.h"

namespace dexremoe {

// Where to write; empty paths of snapshots, curve and tensorboard write nothing.
struct RunPaths {
  std::string out;          // last state, HDF5
  std::string best;         // best state, HDF5
  std::string curve;        // CSV
  std::string tensorboard;  // folder
  std::string snapshots;    // folder: the state at every so many samples, as SAMPLES.h5
};

// How often to write.
struct RunPeriods {
  double checkpoint_minutes = 0;
  double snapshot_samples = 1;  // > 0
};

// Where ADR's ranges over time go: "adr.csv" -> "adr.ranges.csv".
std::string RangesPath(const std::string& curve);

class RunFiles {
 public:
  // `start` is the state that the training starts from or resumes at; the best file of an earlier
  // run is removed when it has no best state.
  RunFiles(RunPaths paths, Provenance provenance, const RunPeriods& periods,
           const TrainState& start);

  // After each iteration of `samples` environment steps. The first state past every multiple of
  // snapshot_samples is written, without environments.
  void Add(const Trainer& trainer, double samples);
  // Whether checkpoint_minutes have gone by since the last Save.
  bool Due() const;
  // Writes the best state when it is another than before, then the last one, a Trainer::Snapshot,
  // and the curve. A kill between them leaves a best file of the future, which the resumed run
  // writes again.
  void Save(const TrainState& last);

 private:
  using Clock = std::chrono::steady_clock;
  void WriteSnapshot(const TrainState& state) const;
  RunPaths paths_;
  Provenance provenance_;
  RunPeriods periods_;
  CurveFile curve_;
  CurveEvents events_;
  std::optional<TrainState> best_;  // not yet written
  Clock::time_point last_;
};

}  // namespace dexremoe
