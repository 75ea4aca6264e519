// Central differences in double against a hand-written gradient.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace dexremoe {

struct GradientReport {
  double worst = 0;       // largest |analytic - numeric| / max(1, |analytic|, |numeric|)
  std::size_t index = 0;  // where
  double analytic = 0, numeric = 0;
  bool ok = false;  // worst <= tolerance
  std::string Text() const;
};

// Compares `gradient` with central differences of loss(x) with step `step`, at every element, or at
// `samples` evenly spread ones when samples > 0.
GradientReport CheckGradient(const std::function<double(const std::vector<double>&)>& loss,
                             std::vector<double> x, const std::vector<double>& gradient,
                             double tolerance = 1e-6, double step = 1e-5, std::size_t samples = 0);

}  // namespace dexremoe
