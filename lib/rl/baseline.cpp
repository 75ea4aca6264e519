#include "rl/baseline.h"

#include <algorithm>

#include "base/check.h"

namespace dexremoe {

const std::vector<std::string>& BaselineMethods() {
  static const std::vector<std::string> methods = {"dr",   "adr",        "privfeat", "privshape",
                                                   "res",  "sparse_moe", "switch",   "mlore",
                                                   "mmoe", "base_long"};
  return methods;
}

bool StartsFromBase(const std::string& method) { return method == "res" || method == "base_long"; }

bool Randomizes(const std::string& method) { return method == "dr" || method == "adr"; }

TrainState StartBaseline(const std::string& method, const StageStart& start,
                         const PolicyOptions& policy, int obs_size, int phys_size, int num_actions,
                         const std::vector<int>& observable, const TrainState* base,
                         const std::string& base_path) {
  if (StartsFromBase(method)) {
    DEX_CHECK(base != nullptr);
    return method == "res" ? StartResidual(start, policy, *base, base_path)
                           : ContinueBase(start, *base, base_path);
  }
  PolicyStructure s = policy.Base(obs_size, phys_size, num_actions);
  if (Randomizes(method)) s.phys_seen = observable;
  s.see_cloud = method != "privfeat" && !Randomizes(method);
  s.see_category = s.see_cloud && method != "privshape";
  if (s.see_category) s = policy.FromScratch(s, method == "switch" ? "switch_moe" : method);
  return StartFresh(start, policy, s, method);
}

}  // namespace dexremoe
