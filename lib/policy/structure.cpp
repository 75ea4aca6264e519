#include "policy/structure.h"

namespace dexremoe {

GateColumns GateColumnsOf(const PolicyStructure& s) {
  if (s.gate_input == "cloud") return {0, s.f_size()};
  if (s.gate_input == "category") return {s.f_size(), s.shape_size() - s.f_size()};
  return {0, s.shape_size()};
}

void PolicyOptions::Register(Options& options) {
  options.Add("policy.hidden", &hidden, "width of the policy's hidden layers").Range(1, 8192);
  options.Add("policy.layers", &layers, "number of the policy's hidden layers").Range(1, 8);
  options
      .Add("policy.cloud_points", &cloud_points,
           "points that mu_pc maps one by one, f being their maximum; 0: it maps PointNet++'s p")
      .Range(0, 65536);
  options.Add("policy.cloud_widths", &cloud_widths, "layers of mu_pc; the last one is f")
      .Range(1, 8192);
  options.Add("policy.extrinsics_widths", &extrinsics_widths, "hidden layers of mu_e")
      .Range(1, 8192);
  options.Add("policy.z_size", &z_size, "width of the extrinsics vector z").Range(1, 8192);
  options.Add("policy.log_std", &log_std, "log standard deviation of the actions at the start")
      .Range(-5, 2);
  options.Add("policy.mean_scale", &mean_scale, "factor on the action head's initial weights")
      .Range(0, 10);
  options.Add("policy.gate_widths", &gate_widths, "hidden layers of the gate (appendix: 64,64)")
      .Range(1, 8192);
  options.Add("policy.gate_input", &gate_input, "what the gate sees of e_shape")
      .Choices({"full", "cloud", "category"});
  options.Add("policy.gate_uniform", &gate_uniform, "weigh all experts alike instead of gating");
  options.Add("policy.experts", &experts, "experts of a mixture trained from scratch").Range(1, 64);
  options
      .Add("policy.shared_width", &shared_width,
           "width of the experts' layers; 0: of policy.hidden 1/1 (switch), 3/4 (sparse_moe), 1/2 "
           "(mmoe, mlore)")
      .Range(0, 8192);
  options.Add("policy.top_k", &top_k, "experts that act at a time (sparse_moe, mlore)")
      .Range(1, 64);
  options.Add("policy.ranks", &ranks, "ranks of the routed experts (mlore)").Range(1, 8192);
  options.Add("policy.category_rank", &category_rank, "rank of a category's own path (mlore)")
      .Range(1, 8192);
}

PolicyStructure PolicyOptions::Base(int obs_size, int phys_size, int num_actions) const {
  PolicyStructure s;
  s.obs_size = obs_size;
  s.phys_size = phys_size;
  s.num_actions = num_actions;
  s.cloud_points = cloud_points;
  s.feature_size = FeatureSize(cloud_points);
  s.cloud_widths = cloud_widths;
  s.extrinsics_widths = extrinsics_widths;
  s.z_size = z_size;
  s.hidden.assign(layers, hidden);
  return s;
}

PolicyStructure PolicyOptions::FromScratch(const PolicyStructure& base,
                                           const std::string& kind) const {
  PolicyStructure s = base;
  s.kind = kind;
  s.experts = experts;
  s.gate_input = gate_input;
  if (kind == "sparse_moe" || kind == "mlore") s.top_k = top_k;
  const int quarters = kind == "switch_moe" ? 4 : kind == "sparse_moe" ? 3 : 2;
  for (int& width : s.hidden) width = shared_width > 0 ? shared_width : (quarters * width + 3) / 4;
  if (kind != "mlore") return s;
  s.ranks = ranks;
  s.category_rank = category_rank;
  return s;
}

PolicyStructure PolicyOptions::Mixture(const PolicyStructure& expert, int experts) const {
  PolicyStructure s = expert;
  s.kind = "soft_mixture";
  s.train_encoders = false;
  s.experts = experts;
  s.gate_widths = gate_widths;
  s.gate_input = gate_input;
  s.gate_uniform = gate_uniform;
  return s;
}

}  // namespace dexremoe
