#include "rl/method_card.h"

#include <filesystem>

#include "base/error.h"
#include "policy/mlore_layer.h"
#include "policy/policy.h"
#include "policy/sparse_moe.h"
#include "policy/switch_moe.h"
#include "rl/policy_file.h"
#include "rl/trainable.h"

namespace dexremoe {
namespace {

std::string InputsOf(const std::string& method, const PolicyStructure& s) {
  std::string text = "o_t";
  if (s.phys_seen.empty())
    text += ", e_phys";
  else
    text += fmt::format(", {} of {} numbers of e_phys", s.phys_seen.size(), s.phys_size);
  if (s.see_cloud)
    text += s.cloud_points > 0 ? fmt::format(", {} points", s.cloud_points) : ", shape";
  if (s.see_category) text += ", category";
  if (s.kind == "residual") text += ", base action";
  return method == "dr" || method == "adr" ? text + " (noisy pose, goal and joints)" : text;
}

std::string NetworkOf(const std::string& method, const PolicyStructure& s) {
  if (s.kind == "residual") return "frozen base + residual network";
  if (s.kind == "sparse_moe")
    return fmt::format("noisy top-{} of {} experts, gate on e_shape", s.top_k, s.experts);
  if (s.kind == "switch_moe")
    return fmt::format("top-1 of {} experts times its probability, gate on e_shape", s.experts);
  if (s.kind == "mmoe")
    return fmt::format("{} shared experts, {} gates and heads", s.experts, s.num_categories);
  if (s.kind == "mlore")
    return fmt::format("shared path + top-{} of ranks {} + a path of rank {} per category", s.top_k,
                       fmt::join(s.ranks, ", "), s.category_rank);
  if (s.kind == "soft_mixture")
    return s.gate_uniform ? fmt::format("average of {} frozen experts", s.experts)
                          : fmt::format("soft gate over {} frozen experts, gate sees {}", s.experts,
                                        s.gate_input == "full" ? "e_shape" : s.gate_input);
  if (method == "base_long") return "the base, trained on";
  return s.train_encoders ? "encoders and policy" : "policy over frozen encoders";
}

std::string LossesOf(const PolicyStructure& s) {
  if (s.kind == "sparse_moe")
    return fmt::format("{} CV^2 importance + {} CV^2 load", NoisyTopK<float>::kImportanceWeight,
                       NoisyTopK<float>::kLoadWeight);
  if (s.kind == "switch_moe")
    return fmt::format("{} E sum f_i P_i", SwitchRouter<float>::kBalanceWeight);
  if (s.kind == "mlore")
    return fmt::format("{} CV^2 importance per layer", MloreLayer::kBalanceWeight);
  return "none";
}

std::string CurriculumOf(const std::string& method, const PpoOptions& ppo) {
  std::string text = "none";
  if (ppo.curriculum)
    text = fmt::format("goals from {} rad, speeds from {} times the limit", ppo.goal_angle_start,
                       ppo.velocity_start);
  if (ppo.curriculum && ppo.gravity_start < 1)
    text += fmt::format(", gravity from {} of its strength", ppo.gravity_start);
  if (ppo.curriculum && ppo.near_share_start > 0)
    text += fmt::format(", {} of them near until both are the task's", ppo.near_share_start);
  if (ppo.curriculum && ppo.curriculum_objects > 0)
    text += fmt::format(", then objects from {} doubling", ppo.curriculum_objects);
  if (ppo.span > 0 && ppo.fall_share_start != 1)
    text += fmt::format(", falls at {} of their price until late", ppo.fall_share_start);
  if (ppo.span > 0 && ppo.kl_end > 0)
    text += fmt::format(", KL threshold from {} to {}", ppo.kl_threshold, ppo.kl_end);
  if (method == "dr") text += "; episodes randomised in fixed ranges";
  if (method == "adr") text += "; episodes randomised in ranges that move with success";
  return text;
}

}  // namespace

MethodCard DescribeMethod(const std::string& method, const PolicyStructure& structure,
                          const PpoOptions& ppo) {
  return {InputsOf(method, structure), NetworkOf(method, structure), LossesOf(structure),
          CurriculumOf(method, ppo)};
}

std::string MethodTable(const std::vector<std::string>& checkpoints, bool missing) {
  std::string text =
      "| method | inputs | network | parameters | in training | own losses | curriculum | samples "
      "|\n|---|---|---|--:|--:|---|---|--:|\n";
  for (const std::string& path : checkpoints) {
    if (missing && !std::filesystem::exists(path)) {
      text += fmt::format("| {} | missing | | | | | | |\n",
                          std::filesystem::path(path).stem().string());
      continue;
    }
    const TrainState state = ReadPolicy(path);
    const auto policy = MakePolicy<float>(state.structure);
    const MethodCard& card = state.card;
    text += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} |\n", state.stage, card.inputs,
                        card.network, policy->layout().size(),
                        TrainableSet(policy->layout(), policy->trainable()).size(), card.losses,
                        card.curriculum, state.samples);
  }
  return text;
}

}  // namespace dexremoe
