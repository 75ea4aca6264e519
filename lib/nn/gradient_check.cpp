#include "nn/gradient_check.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace dexremoe {

std::string GradientReport::Text() const {
  return fmt::format(
      "{}: worst relative difference {:.3g} at element {}: analytic {:.9g}, numeric {:.9g}",
      ok ? "ok" : "WRONG", worst, index, analytic, numeric);
}

GradientReport CheckGradient(const std::function<double(const std::vector<double>&)>& loss,
                             std::vector<double> x, const std::vector<double>& gradient,
                             double tolerance, double step, std::size_t samples) {
  DEX_CHECK_EQ(x.size(), gradient.size());
  GradientReport report;
  const std::size_t checks = samples > 0 ? std::min(samples, x.size()) : x.size();
  for (std::size_t s = 0; s < checks; ++s) {
    const std::size_t i = s * x.size() / checks;
    const double kept = x[i];
    x[i] = kept + step;
    const double above = loss(x);
    x[i] = kept - step;
    const double below = loss(x);
    x[i] = kept;
    const double numeric = (above - below) / (2 * step);
    const double scale = std::max({1.0, std::abs(gradient[i]), std::abs(numeric)});
    double difference = std::abs(gradient[i] - numeric) / scale;
    if (std::isnan(difference)) difference = INFINITY;
    if (s == 0 || difference > report.worst) report = {difference, i, gradient[i], numeric, false};
  }
  report.ok = report.worst <= tolerance;
  return report;
}

}  // namespace dexremoe
