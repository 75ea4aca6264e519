#include "render/resolve.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/check.h"

namespace dexremoe {
namespace {

// Gamma 2.2, the inverse of what the shaders take for sRGB, by table.
constexpr int kSteps = 8192;
std::array<std::uint8_t, kSteps + 1> GammaTable() {
  std::array<std::uint8_t, kSteps + 1> table;
  for (int i = 0; i <= kSteps; ++i)
    table[i] = std::uint8_t(std::lround(255 * std::pow(double(i) / kSteps, 1 / 2.2)));
  return table;
}

}  // namespace

Image Downsample(const std::vector<float>& pixels, int width, int height, int factor) {
  DEX_CHECK_EQ(pixels.size(), std::size_t(4) * width * height * factor * factor);
  static const std::array<std::uint8_t, kSteps + 1> gamma = GammaTable();
  const float share = float(kSteps) / float(factor * factor);
  Image image(width, height, 0, 0, 0);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      std::array<float, 3> sum{};
      for (int dy = 0; dy < factor; ++dy) {
        const std::size_t row = std::size_t(height - 1 - y) * factor + dy;
        const float* from = pixels.data() + 4 * (row * width * factor + std::size_t(x) * factor);
        for (int dx = 0; dx < factor; ++dx)
          for (int k = 0; k < 3; ++k) sum[k] += from[4 * dx + k];
      }
      for (int k = 0; k < 3; ++k) {
        const float value = std::clamp(sum[k] * share, 0.0f, float(kSteps));
        image.at(x, y)[k] = gamma[int(value + 0.5f)];
      }
    }
  return image;
}

}  // namespace dexremoe
