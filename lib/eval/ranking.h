// The objects that a policy turns best and worst (paper, section IV-C and figure 4), and how their
// episodes end.
#pragma once

#include <string>
#include <vector>

#include "eval/eval_file.h"
#include "eval/outcome.h"

namespace dexremoe {

struct RankedObject {
  std::string name, category, split;
  int episodes = 0;
  Estimate successes;    // S_i
  OutcomeShares shares;  // how its episodes end
};

struct Ranking {
  std::string policy;  // file name
  std::string engine;
  double tolerance = 0;             // rad
  bool jams_known = true;           // else jams are counted as time
  std::vector<RankedObject> worst;  // ascending in S_i
  std::vector<RankedObject> best;   // descending
};

// The `count` best and worst objects of `split` ("train", "ood" or "all") in a run of `eval`; at
// most half of the objects each, ties by name. Throws Error when there are fewer than two.
Ranking RankObjects(const EvalFile& eval, const EvalRun& run, const std::string& split, int count);

std::string MarkdownOf(const Ranking& ranking);
// One line per object: group,place,object,category,split,episodes,s,s_low,s_high,falls,jams,time.
std::string CsvOf(const Ranking& ranking);

}  // namespace dexremoe
