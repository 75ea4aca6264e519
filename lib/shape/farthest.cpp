#include "shape/farthest.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "base/check.h"
#include "nn/vectorized.h"

// PCL 1.13 has a FarthestPointSampling filter, but it draws its first point with
// std::uniform_int_distribution: another point of the surface for every seed and standard library,
// and never the one farthest from the centroid. Hence our own; the tests compare the two from PCL's
// start.

namespace dexremoe {
namespace {

// Coordinates apart, so that the loop below runs over contiguous arrays.
struct Columns {
  std::vector<float> x, y, z;
};

// Lowers nearest[i] to the squared distance from (px, py, pz) and returns the largest of them as
// its bit pattern: squared distances are never negative, and such floats order like their bits,
// which the compiler can reduce in a vector.
DEX_VECTORIZED
std::int32_t LowerDistances(int count, const float* x, const float* y, const float* z, float px,
                            float py, float pz, float* nearest) {
  std::int32_t largest = 0;
  DEX_INDEPENDENT
  for (int i = 0; i < count; ++i) {
    const float dx = x[i] - px, dy = y[i] - py, dz = z[i] - pz;
    const float distance = dx * dx + dy * dy + dz * dz;
    const float lower = distance < nearest[i] ? distance : nearest[i];
    nearest[i] = lower;
    const std::int32_t bits = std::bit_cast<std::int32_t>(lower);
    largest = bits > largest ? bits : largest;
  }
  return largest;
}

Columns SplitColumns(std::span<const float> xyz) {
  const std::size_t n = xyz.size() / 3;
  Columns columns{std::vector<float>(n), std::vector<float>(n), std::vector<float>(n)};
  for (std::size_t i = 0; i < n; ++i) {
    columns.x[i] = xyz[3 * i];
    columns.y[i] = xyz[3 * i + 1];
    columns.z[i] = xyz[3 * i + 2];
  }
  return columns;
}

int FarthestFromCentroid(const Columns& columns) {
  const std::size_t n = columns.x.size();
  double cx = 0, cy = 0, cz = 0;
  for (std::size_t i = 0; i < n; ++i) {
    cx += columns.x[i];
    cy += columns.y[i];
    cz += columns.z[i];
  }
  std::vector<float> distance(n, INFINITY);
  const std::int32_t largest =
      LowerDistances(static_cast<int>(n), columns.x.data(), columns.y.data(), columns.z.data(),
                     static_cast<float>(cx / n), static_cast<float>(cy / n),
                     static_cast<float>(cz / n), distance.data());
  const auto found = std::find(distance.begin(), distance.end(), std::bit_cast<float>(largest));
  return found == distance.end() ? 0 : static_cast<int>(found - distance.begin());
}

}  // namespace

std::vector<int> FarthestPointOrder(std::span<const float> xyz, int count, int start) {
  const int n = static_cast<int>(xyz.size() / 3);
  DEX_CHECK_LE(count, n);
  DEX_CHECK_LT(start, n);
  if (count <= 0) return {};
  const Columns columns = SplitColumns(xyz);
  std::vector<float> nearest(n, INFINITY);
  std::vector<bool> taken(n, false);
  std::vector<int> order;
  order.reserve(count);
  int next = start >= 0 ? start : FarthestFromCentroid(columns);
  for (;;) {
    order.push_back(next);
    taken[next] = true;
    if (static_cast<int>(order.size()) == count) return order;
    const std::int32_t bits =
        LowerDistances(n, columns.x.data(), columns.y.data(), columns.z.data(), columns.x[next],
                       columns.y[next], columns.z[next], nearest.data());
    const float largest = std::bit_cast<float>(bits);
    next = static_cast<int>(std::find(nearest.begin(), nearest.end(), largest) - nearest.begin());
    // Only copies of points already taken are left: take them in index order.
    if (next == n || taken[next])
      next = static_cast<int>(std::find(taken.begin(), taken.end(), false) - taken.begin());
  }
}

}  // namespace dexremoe
