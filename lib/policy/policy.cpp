#include "policy/policy.h"

#include "base/error.h"
#include "policy/actor_critic.h"
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
  CheckPositive("cloud_widths", s.cloud_widths);
  CheckPositive("extrinsics_widths", s.extrinsics_widths);
  CheckPositive("hidden", s.hidden);
  if (s.kind != "soft_mixture") return;
  CheckPositive("experts", {s.experts});
  CheckPositive("gate_widths", s.gate_widths);
  if (s.gate_input != "full" && s.gate_input != "cloud" && s.gate_input != "category")
    Fail("policy structure: gate_input: expected full, cloud or category, found '{}'",
         s.gate_input);
}

}  // namespace

template <typename T>
std::unique_ptr<Policy<T>> MakePolicy(const PolicyStructure& structure) {
  CheckStructure(structure);
  if (structure.kind == "actor_critic") return std::make_unique<ActorCritic<T>>(structure);
  if (structure.kind == "soft_mixture") return std::make_unique<SoftMixture<T>>(structure);
  Fail("policy structure: kind: expected actor_critic or soft_mixture, found '{}'", structure.kind);
}

template std::unique_ptr<Policy<BFloat16>> MakePolicy(const PolicyStructure&);
template std::unique_ptr<Policy<float>> MakePolicy(const PolicyStructure&);
template std::unique_ptr<Policy<double>> MakePolicy(const PolicyStructure&);

}  // namespace dexremoe
