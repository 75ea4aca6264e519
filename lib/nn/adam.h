// Adam (Kingma & Ba 2015) over a flat parameter array, and gradient clipping.
#pragma once

#include <cstdint>
#include <vector>

namespace dexremoe {

struct AdamOptions {
  double beta1 = 0.9;
  double beta2 = 0.999;
  double epsilon = 1e-8;
};

// Whole state, stored in checkpoints.
struct AdamState {
  std::vector<float> m, v;
  std::int64_t step = 0;
};

// params -= rate * mhat / (sqrt(vhat) + epsilon). Sizes equal; state is sized on first use.
void AdamStep(const AdamOptions& options, double rate, const std::vector<float>& grads,
              AdamState& state, std::vector<float>& params);

// Scales grads to a Euclidean norm of at most max_norm; returns the norm before.
double ClipGradient(double max_norm, std::vector<float>& grads);

}  // namespace dexremoe
