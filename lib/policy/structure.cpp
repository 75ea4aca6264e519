#include "policy/structure.h"

namespace dexremoe {

void PolicyOptions::Register(Options& options) {
  options.Add("policy.hidden", &hidden, "width of the policy's hidden layers").Range(1, 8192);
  options.Add("policy.layers", &layers, "number of the policy's hidden layers").Range(1, 8);
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
}

PolicyStructure PolicyOptions::Base(int obs_size, int phys_size, int num_actions) const {
  PolicyStructure s;
  s.obs_size = obs_size;
  s.phys_size = phys_size;
  s.num_actions = num_actions;
  s.cloud_widths = cloud_widths;
  s.extrinsics_widths = extrinsics_widths;
  s.z_size = z_size;
  s.hidden.assign(layers, hidden);
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
