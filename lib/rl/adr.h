// Automatic domain randomisation (OpenAI et al. 2019, "Solving Rubik's Cube with a Robot Hand",
// algorithm 1): ranges start at the plain task and widen where the policy still succeeds.
//
// A share of the episodes stands at one bound of one range (task/randomization.h). Their successes
// go into that bound's queue; when it is full, its mean moves the bound outwards (above `high`),
// inwards (below `low`) or not, and the queue is emptied.
//
// NOTE(paper): OpenAI moves bounds at 10 and 20 successes of 50, DeXtreme at 5 and 20; what can be
// reached here is less, so both thresholds are options.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/options.h"
#include "task/reorient.h"

namespace dexremoe {

struct AdrOptions {
  bool on = false;                  // set by the method, not by a user
  int queue = 256;                  // boundary episodes per decision
  double low = 0.5, high = 1.0;     // successes per episode
  double boundary_share = 0.5;      // of the episodes
  void Register(Options& options);  // section "adr"
  void Check() const;               // throws UsageError
};

// Whole state, stored in checkpoints. P parameters, in the order of kRandomParameters.
struct AdrState {
  std::vector<double> low, high;           // [P]
  std::vector<std::vector<double>> queue;  // [2 P], see BoundMoves
  // How the ranges went: samples, then low and high of each parameter; a row per change.
  std::vector<std::vector<double>> history;
  bool empty() const { return low.empty(); }
};

AdrState StartAdr();
// Accounts for the episodes that ended by `samples`; returns true when a range changed.
bool UpdateAdr(const AdrOptions& options, const std::vector<EpisodeRecord>& records,
               std::int64_t samples, AdrState& state);

// Columns of AdrState::history: "samples", "size_low", "size_high", ...
std::vector<std::string> AdrColumns();
// The history as CSV.
std::string AdrCsv(const AdrState& state);

}  // namespace dexremoe
