// A policy with its numbers, in the precision that its structure names.
#pragma once

#include <memory>
#include <vector>

#include "policy/policy.h"

namespace dexremoe {

// The master parameters stay float and with the optimiser; this holds what Load made of them.
// Inputs, outputs and gradients are float and as Policy<float> has them. `worker` names the scratch
// memory: calls with different workers may run side by side.
class PolicyNet {
 public:
  virtual ~PolicyNet() = default;

  virtual void Load(const std::vector<float>& params) = 0;
  virtual void Freeze(int worker, const ShapeInputs<float>& shapes, const PolicyRows<float>& rows,
                      float* frozen) = 0;
  virtual void Forward(int worker, const ShapeInputs<float>& shapes, const PolicyRows<float>& rows,
                       float* mean, float* value) = 0;
  // Between Forward and Backward; see Policy.
  virtual void Balance(int worker, const ShapeInputs<float>& shapes, const PolicyRows<float>& rows,
                       float weight, RoutingSums& sums) = 0;
  // After Forward with the same arguments.
  virtual void Backward(int worker, const ShapeInputs<float>& shapes, const PolicyRows<float>& rows,
                        const float* dmean, const float* dvalue, float* grads) = 0;
};

// Throws Error for a precision that is not known or not to be had on this processor.
std::unique_ptr<PolicyNet> MakePolicyNet(const PolicyStructure& structure, int workers);

}  // namespace dexremoe
