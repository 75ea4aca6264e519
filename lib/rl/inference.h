// A policy's forward pass over many rows, spread over the threads in fixed blocks.
#pragma once

#include <vector>

#include "base/thread_pool.h"
#include "policy/policy_net.h"

namespace dexremoe {

// Where the results of Inference::Run go; null ones are not wanted.
struct InferenceOutput {
  float* mean = nullptr;    // [n, A]
  float* value = nullptr;   // [n]
  float* frozen = nullptr;  // [n, frozen_size()]
};

class Inference {
 public:
  // Computes in the precision of the policy's structure. Both must outlive this.
  Inference(const Policy<float>& policy, ThreadPool& pool);

  void Run(const std::vector<float>& params, const ShapeInputs<float>& shapes,
           const PolicyRows<float>& rows, const InferenceOutput& out);

 private:
  struct Scratch {
    std::vector<float> mean, value, frozen;
  };
  void RunBlock(int worker, const ShapeInputs<float>& shapes, const PolicyRows<float>& rows,
                const InferenceOutput& out, std::int64_t begin);

  const Policy<float>& policy_;
  ThreadPool& pool_;
  std::unique_ptr<PolicyNet> net_;
  std::vector<Scratch> scratch_;  // per worker
};

}  // namespace dexremoe
