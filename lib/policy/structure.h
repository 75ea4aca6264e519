// What a policy is made of. Stored in every checkpoint, so a file can build its own network.
#pragma once

#include <string>
#include <vector>

#include "base/options.h"

namespace dexremoe {

// Numbers that tell a policy an object's shape: p, or three of each point.
inline int FeatureSize(int cloud_points) { return cloud_points > 0 ? 3 * cloud_points : 100; }

struct PolicyStructure {
  std::string kind = "actor_critic";  // or another that MakePolicy knows
  // Inputs and outputs (paper, III-B).
  int obs_size = 66;                  // o_t
  int phys_size = 23;                 // e_phys
  int feature_size = FeatureSize(0);  // p, or the coordinates of cloud_points points
  int num_categories = 6;             // one-hot
  int num_actions = 11;
  // What of it reaches the networks beside o_t: these columns of e_phys (empty: all), mu_pc(p), and
  // the category.
  std::vector<int> phys_seen;
  bool see_cloud = true, see_category = true;
  // Encoders.
  // NOTE(paper): its wording also fits a PointNet on sampled points. 0: mu_pc maps p to f.
  // Otherwise it maps each of so many points, and f is the maximum over them.
  int cloud_points = 0;
  std::vector<int> cloud_widths = {32, 32, 32};     // mu_pc; the last one is f
  std::vector<int> extrinsics_widths = {256, 128};  // hidden layers of mu_e
  int z_size = 66;
  bool train_encoders = true;  // false once the base is trained
  // Policy.
  std::vector<int> hidden = {512, 512};
  // Mixtures.
  int experts = 0;
  int top_k = 0;           // sparse_moe and mlore: experts that act at a time
  std::vector<int> ranks;  // mlore: of the routed experts; as many as `experts`
  int category_rank = 0;   // mlore: of each category's own path
  std::vector<int> gate_widths = {64};
  std::string gate_input = "full";  // e_shape: "full", or the part "cloud" or "category" alone
  bool gate_uniform = false;        // all weights 1 / experts, no gate
  // "f32" or "bf16": what training computes in. Parameters are kept, and evaluated, in float32.
  std::string precision = "f32";

  int f_size() const { return see_cloud ? cloud_widths.back() : 0; }
  int shape_size() const { return f_size() + (see_category ? num_categories : 0); }  // e_shape
  int phys_inputs() const {
    return phys_seen.empty() ? phys_size : static_cast<int>(phys_seen.size());
  }
};

// Columns of e_shape = [f, one-hot] that a gate sees.
struct GateColumns {
  int begin = 0, size = 0;
};
GateColumns GateColumnsOf(const PolicyStructure& structure);

// What a person chooses of it; section "policy".
struct PolicyOptions {
  int hidden = 512;
  int layers = 2;
  int cloud_points = 0;
  std::vector<int> cloud_widths = {32, 32, 32};
  std::vector<int> extrinsics_widths = {256, 128};
  int z_size = 66;
  double log_std = 0;     // at the start of the base
  double mean_scale = 1;  // on the initial weights of the action head
  std::vector<int> gate_widths = {64};
  std::string gate_input = "full";
  bool gate_uniform = false;
  // Mixtures that are trained from scratch.
  int experts = 4;
  // Of the experts' layers; 0: of `hidden` all (switch), 3/4 (sparse_moe), 1/2 (mmoe, mlore), so
  // that parameters and arithmetic stay near the base's although several paths act.
  int shared_width = 0;
  int top_k = 2;
  std::vector<int> ranks = {16, 32, 48, 64};
  int category_rank = 40;  // the mean of the ranks, as in MLoRE

  void Register(Options& options);
  // The base policy for a task with these sizes.
  PolicyStructure Base(int obs_size, int phys_size, int num_actions) const;
  // `base` as a mixture of this kind that is trained from scratch.
  PolicyStructure FromScratch(const PolicyStructure& base, const std::string& kind) const;
  // The mixture of `experts` copies of `expert`.
  PolicyStructure Mixture(const PolicyStructure& expert, int experts) const;
};

}  // namespace dexremoe
