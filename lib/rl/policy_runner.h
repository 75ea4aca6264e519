// A trained policy, read from a file and ready to act: evaluation, rendering, gate plots.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/thread_pool.h"
#include "task/object_set.h"

namespace dexremoe {

class PolicyRunner {
 public:
  // Reads any dexremoe.checkpoint (base, expert or gate) or dexremoe.weights. `objects` need their
  // features loaded; they may differ from those of the training (out of distribution) and may be
  // empty when only WeightsOf is used. Their features are what
  // ReadPolicyStructure(path).cloud_points asks for. Computes in float32, also what was trained in
  // bfloat16. `pool` must outlive the runner. Throws Error naming file and field.
  PolicyRunner(const std::string& path, const std::vector<TaskObject>& objects, ThreadPool& pool);
  ~PolicyRunner();
  PolicyRunner(const PolicyRunner&) = delete;
  PolicyRunner& operator=(const PolicyRunner&) = delete;

  const std::string& kind() const;  // "actor_critic" or "soft_mixture"
  int obs_size() const;             // 66
  int phys_size() const;            // 23
  int num_actions() const;          // 11
  std::int64_t samples() const;     // environment steps that its training stage has seen

  // Deterministic actions, the means [n, num_actions], not clamped (the task clamps). obs
  // [n, obs_size] and phys [n, phys_size] as ReorientBatch gives them; object [n] indexes
  // `objects`.
  void Act(const std::vector<float>& obs, const std::vector<float>& phys,
           const std::vector<int>& object, std::vector<float>& actions);
  // The same with exploration noise; row r at step t draws from (seed, kAction, {t, r}).
  void Sample(const std::vector<float>& obs, const std::vector<float>& phys,
              const std::vector<int>& object, std::uint64_t seed, std::uint64_t t,
              std::vector<float>& actions);

  // Experts behind the gate; 0 for a policy without one.
  int gates() const;
  // [objects, gates()], rows sum to one; empty without a gate.
  const std::vector<float>& GateWeights() const;
  // Weights for other descriptors: feature [m, feature_size] (unnormalised), category [m] -> [m,
  // gates()]. Used with rotated clouds (paper, figure 8).
  std::vector<float> WeightsOf(const std::vector<float>& feature,
                               const std::vector<int>& category) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dexremoe
