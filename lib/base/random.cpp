#include "base/random.h"

#include <cmath>
#include <numbers>

namespace dexremoe {
namespace {

constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15ull;

std::uint64_t Mix(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  return z ^ (z >> 31);
}

}  // namespace

std::uint64_t SeedOf(std::uint64_t seed, Stream stream,
                     std::initializer_list<std::uint64_t> indices) {
  std::uint64_t h = Mix(seed + kGolden);
  h = Mix(h ^ (static_cast<std::uint64_t>(stream) * kGolden));
  for (const std::uint64_t index : indices) h = Mix(h + kGolden + Mix(index + kGolden));
  return h;
}

std::uint64_t Rng::Next() {
  state_ += kGolden;
  return Mix(state_);
}

double Rng::Uniform() { return static_cast<double>(Next() >> 11) * 0x1p-53; }

double Rng::Uniform(double low, double high) { return low + (high - low) * Uniform(); }

std::uint64_t Rng::Index(std::uint64_t n) {
  // Multiply-shift (Lemire 2019); the bias is below n / 2^64.
  return static_cast<std::uint64_t>((static_cast<unsigned __int128>(Next()) * n) >> 64);
}

double Rng::Normal() {
  const double radius = std::sqrt(-2 * std::log(1 - Uniform()));
  return radius * std::cos(2 * std::numbers::pi * Uniform());
}

std::array<double, 4> Rng::UnitQuaternion() {
  for (;;) {
    std::array<double, 4> q;
    double norm2 = 0;
    for (double& x : q) {
      x = Normal();
      norm2 += x * x;
    }
    if (norm2 < 1e-12) continue;
    const double scale = (q[0] < 0 ? -1 : 1) / std::sqrt(norm2);
    for (double& x : q) x *= scale;
    return q;
  }
}

}  // namespace dexremoe
