#include "nn/adam.h"

#include <cmath>

#include "base/check.h"
#include "nn/vectorized.h"

namespace dexremoe {
namespace {

// The constants of one step, in float.
struct StepConstants {
  float beta1, rest1;  // beta1, 1 - beta1
  float beta2, rest2;
  float rate;    // learning rate / (1 - beta1^t)
  float scale2;  // 1 / (1 - beta2^t)
  float epsilon;
};

DEX_VECTORIZED
void Step(std::int64_t count, const StepConstants& k, const float* grads, float* m, float* v,
          float* params) {
  const StepConstants c = k;
  DEX_INDEPENDENT
  for (std::int64_t i = 0; i < count; ++i) {
    const float g = grads[i];
    const float first = c.beta1 * m[i] + c.rest1 * g;
    const float second = c.beta2 * v[i] + c.rest2 * g * g;
    m[i] = first;
    v[i] = second;
    params[i] -= c.rate * first / (__builtin_sqrtf(second * c.scale2) + c.epsilon);
  }
}

DEX_VECTORIZED
void Scale(std::int64_t count, float factor, float* values) {
  for (std::int64_t i = 0; i < count; ++i) values[i] *= factor;
}

}  // namespace

void AdamStep(const AdamOptions& options, double rate, const std::vector<float>& grads,
              AdamState& state, std::vector<float>& params) {
  if (state.m.empty()) {
    state.m.assign(params.size(), 0.0f);
    state.v.assign(params.size(), 0.0f);
  }
  DEX_CHECK_EQ(grads.size(), params.size());
  DEX_CHECK_EQ(state.m.size(), params.size());
  DEX_CHECK_EQ(state.v.size(), params.size());
  const double t = static_cast<double>(++state.step);
  StepConstants k;
  k.beta1 = static_cast<float>(options.beta1);
  k.rest1 = static_cast<float>(1 - options.beta1);
  k.beta2 = static_cast<float>(options.beta2);
  k.rest2 = static_cast<float>(1 - options.beta2);
  k.rate = static_cast<float>(rate / (1 - std::pow(options.beta1, t)));
  k.scale2 = static_cast<float>(1 / (1 - std::pow(options.beta2, t)));
  k.epsilon = static_cast<float>(options.epsilon);
  Step(static_cast<std::int64_t>(params.size()), k, grads.data(), state.m.data(), state.v.data(),
       params.data());
}

double ClipGradient(double max_norm, std::vector<float>& grads) {
  // Eight running sums, element i in sum i mod 8: a fixed order that keeps the adder busy.
  double sums[8] = {};
  for (std::size_t i = 0; i < grads.size(); ++i) {
    const double g = grads[i];
    sums[i % 8] += g * g;
  }
  double total = 0;
  for (const double sum : sums) total += sum;
  const double norm = std::sqrt(total);
  if (norm > max_norm)
    Scale(static_cast<std::int64_t>(grads.size()), static_cast<float>(max_norm / norm),
          grads.data());
  return norm;
}

}  // namespace dexremoe
