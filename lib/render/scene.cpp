#include "render/scene.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace dexremoe::palette {

Eigen::Vector3f Distinct(int index) {
  static const std::array<Eigen::Vector3f, 8> colors = {{{0.00f, 0.45f, 0.70f},
                                                         {0.90f, 0.60f, 0.00f},
                                                         {0.00f, 0.62f, 0.45f},
                                                         {0.80f, 0.35f, 0.05f},
                                                         {0.34f, 0.71f, 0.91f},
                                                         {0.80f, 0.47f, 0.65f},
                                                         {0.94f, 0.80f, 0.22f},
                                                         {0.45f, 0.45f, 0.48f}}};
  return colors[index % int(colors.size())];
}

Eigen::Vector3f Wheel(int index) {
  const double hue = 6 * std::fmod(0.06 + 0.618034 * index, 1.0);  // steps of the golden ratio
  const float value = index % 3 == 1 ? 0.80f : 0.90f, low = index % 2 == 0 ? 0.42f : 0.52f;
  Eigen::Vector3f color;
  for (int k = 0; k < 3; ++k) {
    const double part = std::fmod(5 - 2 * k + hue, 6.0);  // HSV by the usual piecewise lines
    color[k] = value - (value - low) * float(std::clamp(std::min(part, 4 - part), 0.0, 1.0));
  }
  return color;
}

}  // namespace dexremoe::palette
