// The file of an evaluation (dexremoe.eval): every episode as columns, and what they add up to.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "eval/metrics.h"
#include "io/h5.h"

namespace dexremoe {

inline constexpr H5Format kEvalFormat{"dexremoe.eval", 2};

// The episodes at one success tolerance. The tolerance decides when goals switch, so each
// tolerance has episodes of its own.
struct EvalRun {
  double tolerance = 0;                 // rad
  std::vector<EpisodeRecord> episodes;  // object and episode filled; env is not kept
  Metrics metrics;
};

struct EvalObject {
  std::string name, category, split;
};

struct EvalFile {
  std::string policy;        // file name
  std::int64_t samples = 0;  // that its training has seen; evaluate --earlier adds stages
  std::string engine;        // simulation engine
  int substeps = 0;          // physics steps per control step
  std::uint64_t seed = 0;
  double push = 0;                       // N; 0 = no disturbance
  std::string category_input = "label";  // or "predicted" or "soft": EvalOptions::category
  bool jams_known = true;                // false for files older than EpisodeRecord::still
  std::vector<EvalObject> objects;
  std::vector<EvalRun> runs;
};

void WriteEval(const std::string& path, const EvalFile& eval, const Provenance& provenance);
// Reads the episodes; metrics are taken from the file. Throws Error.
EvalFile ReadEval(const std::string& path);

// The run at this tolerance (within 1e-9), or nullptr.
const EvalRun* FindRun(const EvalFile& eval, double tolerance);
// The run's episodes whose object belongs to `split` ("all" for every one).
std::vector<EpisodeRecord> EpisodesOfSplit(const EvalFile& eval, const EvalRun& run,
                                           const std::string& split);

}  // namespace dexremoe
