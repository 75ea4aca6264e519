// What a policy is made of. Stored in every checkpoint, so a file can build its own network.
#pragma once

#include <string>
#include <vector>

#include "base/options.h"

namespace dexremoe {

struct PolicyStructure {
  std::string kind = "actor_critic";  // or "soft_mixture"
  // Inputs and outputs (paper, III-B).
  int obs_size = 66;       // o_t
  int phys_size = 23;      // e_phys
  int feature_size = 100;  // p
  int num_categories = 6;  // one-hot
  int num_actions = 11;
  // Encoders.
  std::vector<int> cloud_widths = {32, 32, 32};     // mu_pc; the last one is f
  std::vector<int> extrinsics_widths = {256, 128};  // hidden layers of mu_e
  int z_size = 66;
  bool train_encoders = true;  // false once the base is trained
  // Policy.
  std::vector<int> hidden = {512, 512};
  // Mixture.
  int experts = 0;
  std::vector<int> gate_widths = {64};
  std::string gate_input = "full";  // e_shape: "full", or the part "cloud" or "category" alone
  bool gate_uniform = false;        // all weights 1 / experts, no gate
  // "f32" or "bf16": what training computes in. Parameters are kept, and evaluated, in float32.
  std::string precision = "f32";

  int f_size() const { return cloud_widths.back(); }
  int shape_size() const { return f_size() + num_categories; }  // e_shape
};

// What a person chooses of it; section "policy".
struct PolicyOptions {
  int hidden = 512;
  int layers = 2;
  std::vector<int> cloud_widths = {32, 32, 32};
  std::vector<int> extrinsics_widths = {256, 128};
  int z_size = 66;
  double log_std = 0;     // at the start of the base
  double mean_scale = 1;  // on the initial weights of the action head
  std::vector<int> gate_widths = {64};
  std::string gate_input = "full";
  bool gate_uniform = false;

  void Register(Options& options);
  // The base policy for a task with these sizes.
  PolicyStructure Base(int obs_size, int phys_size, int num_actions) const;
  // The mixture of `experts` copies of `expert`.
  PolicyStructure Mixture(const PolicyStructure& expert, int experts) const;
};

}  // namespace dexremoe
