#include "policy/policy.h"

#include "base/error.h"
#include "policy/actor_critic.h"
#include "policy/mlore.h"
#include "policy/mmoe.h"
#include "policy/residual.h"
#include "policy/routed_mixture.h"
#include "policy/soft_mixture.h"

namespace dexremoe {
namespace {

void CheckPositive(const char* field, const std::vector<int>& widths) {
  if (widths.empty()) Fail("policy structure: {}: expected at least one layer, found none", field);
  for (const int width : widths)
    if (width <= 0) Fail("policy structure: {}: expected positive widths, found {}", field, width);
}

void CheckStructure(const PolicyStructure& s) {
  CheckPositive("sizes", {s.obs_size, s.phys_size, s.feature_size, s.num_categories, s.num_actions,
                          s.z_size});
  if (s.cloud_points > 0 && s.feature_size != FeatureSize(s.cloud_points))
    Fail("policy structure: feature_size: expected {} for {} points, found {}",
         FeatureSize(s.cloud_points), s.cloud_points, s.feature_size);
  CheckPositive("cloud_widths", s.cloud_widths);
  CheckPositive("extrinsics_widths", s.extrinsics_widths);
  CheckPositive("hidden", s.hidden);
  for (const int column : s.phys_seen)
    if (column < 0 || column >= s.phys_size)
      Fail("policy structure: phys_seen: expected columns below {}, found {}", s.phys_size, column);
  if (s.kind == "soft_mixture") CheckPositive("gate_widths", s.gate_widths);
  if (s.kind == "actor_critic" || s.kind == "residual") return;
  CheckPositive("experts", {s.experts});
  if (s.gate_input != "full" && s.gate_input != "cloud" && s.gate_input != "category")
    Fail("policy structure: gate_input: expected full, cloud or category, found '{}'",
         s.gate_input);
  CheckPositive("gate_input's columns", {GateColumnsOf(s).size});
  const bool top_k = s.kind == "sparse_moe" || s.kind == "mlore";
  if (top_k && (s.top_k < 1 || s.top_k > s.experts))
    Fail("policy structure: top_k: expected 1..{}, found {}", s.experts, s.top_k);
  if (s.kind != "mlore") return;
  CheckPositive("ranks", s.ranks);
  CheckPositive("category_rank", {s.category_rank});
  if (static_cast<int>(s.ranks.size()) != s.experts)
    Fail("policy structure: ranks: expected one for each of {} experts, found {}", s.experts,
         s.ranks.size());
}

}  // namespace

template <typename T>
std::unique_ptr<Policy<T>> MakePolicy(const PolicyStructure& structure) {
  CheckStructure(structure);
  if (structure.kind == "actor_critic") return std::make_unique<ActorCritic<T>>(structure);
  if (structure.kind == "soft_mixture") return std::make_unique<SoftMixture<T>>(structure);
  if (structure.kind == "sparse_moe" || structure.kind == "switch_moe")
    return std::make_unique<RoutedMixture<T>>(structure);
  if (structure.kind == "mmoe") return std::make_unique<MultiGateMixture<T>>(structure);
  if (structure.kind == "mlore") return std::make_unique<LowRankMixture<T>>(structure);
  if (structure.kind == "residual") return std::make_unique<ResidualPolicy<T>>(structure);
  Fail(
      "policy structure: kind: expected actor_critic, soft_mixture, sparse_moe, switch_moe, mmoe, "
      "mlore or residual, found '{}'",
      structure.kind);
}

template std::unique_ptr<Policy<BFloat16>> MakePolicy(const PolicyStructure&);
template std::unique_ptr<Policy<float>> MakePolicy(const PolicyStructure&);
template std::unique_ptr<Policy<double>> MakePolicy(const PolicyStructure&);

}  // namespace dexremoe
