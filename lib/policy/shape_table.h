// The objects of a run as the networks see them: descriptor p (or points) and category, one row per
// object.
#pragma once

#include <string>
#include <vector>

#include "nn/normalizer.h"
#include "policy/policy.h"
#include "task/object_set.h"

namespace dexremoe {

struct ShapeTable {
  std::vector<std::string> names;
  std::vector<float> feature;  // [K, feature_size], as described, not normalised
  std::vector<int> category;   // [K]
  // [K, categories] what stands in for the one-hot category, such as predictions; empty: nothing.
  std::vector<float> category_input = {};
  int objects() const { return static_cast<int>(names.size()); }
};

// Throws Error naming the object whose descriptor is missing or of another size.
ShapeTable MakeShapeTable(const std::vector<TaskObject>& objects,
                          int feature_size = kShapeFeatureSize);

// A table ready for a policy: normalised descriptors and categories.
class ShapeRows {
 public:
  ShapeRows(const ShapeTable& table, const RunningMoments& moments, double clip,
            int num_categories);
  ShapeInputs<float> inputs() const { return {objects_, feature_.data(), category_.data()}; }

 private:
  std::int64_t objects_;
  std::vector<float> feature_, category_;
};

}  // namespace dexremoe
