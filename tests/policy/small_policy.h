// Small policies and random inputs for them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/random.h"
#include "policy/policy.h"

namespace dexremoe {

inline PolicyStructure SmallBase() {
  PolicyStructure s;
  s.obs_size = 5;
  s.phys_size = 4;
  s.feature_size = 7;
  s.num_actions = 3;
  s.cloud_widths = {6, 5};
  s.extrinsics_widths = {8, 7};
  s.z_size = 6;
  s.hidden = {10, 9};
  return s;
}

inline PolicyStructure SmallMixture(const std::string& gate_input) {
  PolicyStructure s = SmallBase();
  s.kind = "soft_mixture";
  s.train_encoders = false;
  s.experts = 3;
  s.gate_widths = {8, 8};
  s.gate_input = gate_input;
  return s;
}

// A mixture of four experts that is trained from scratch.
inline PolicyStructure SmallRouted(const std::string& kind) {
  PolicyStructure s = SmallBase();
  s.kind = kind;
  s.cloud_widths = {5, 4};
  s.extrinsics_widths = {6};
  s.z_size = 4;
  s.hidden = {6, 5};
  s.experts = 4;
  s.top_k = 2;
  s.ranks = {1, 2, 3, 4};
  s.category_rank = 2;
  return s;
}

// Random inputs of n rows over K objects, and random weights of a scalar loss.
template <typename T>
struct Problem {
  Problem(const PolicyStructure& s, std::int64_t rows, std::int64_t objects) : n(rows), k(objects) {
    Rng rng(3, Stream::kTest, {1});
    const auto draw = [&](std::int64_t count) {
      std::vector<T> values(count);
      for (T& v : values) v = static_cast<T>(rng.Normal());
      return values;
    };
    obs = draw(n * s.obs_size);
    phys = draw(n * s.phys_size);
    feature = draw(k * s.feature_size);
    category.assign(k * s.num_categories, T(0));
    for (std::int64_t i = 0; i < k; ++i) category[i * s.num_categories + i % s.num_categories] = 1;
    for (std::int64_t i = 0; i < n; ++i) object.push_back(static_cast<int>((2 * i + 1) % k));
    dmean = draw(n * s.num_actions);
    dvalue = draw(n);
  }
  // Draws of the policy's router; the rows bring them from then on.
  void DrawNoise(const Policy<T>& policy) {
    std::vector<float> drawn(policy.noise_size());
    for (std::int64_t r = 0; r < n; ++r) {
      Rng rng(6, Stream::kTest, {static_cast<std::uint64_t>(r)});
      policy.DrawNoise(rng, drawn.data());
      noise.insert(noise.end(), drawn.begin(), drawn.end());
    }
  }
  PolicyRows<T> rows() const {
    return {
        n, obs.data(), phys.data(), object.data(), nullptr, noise.empty() ? nullptr : noise.data()};
  }
  ShapeInputs<T> shapes() const { return {k, feature.data(), category.data()}; }

  std::int64_t n, k;
  std::vector<T> obs, phys, feature, category, dmean, dvalue, noise;
  std::vector<int> object;
};

}  // namespace dexremoe
