#include "policy/shape_table.h"

#include "base/check.h"
#include "base/error.h"

namespace dexremoe {

ShapeTable MakeShapeTable(const std::vector<TaskObject>& objects, int feature_size) {
  ShapeTable table;
  for (const TaskObject& object : objects) {
    if (std::ssize(object.feature) != feature_size)
      Fail("object {}: descriptor: expected {} values, found {}", object.name, feature_size,
           object.feature.size());
    table.names.push_back(object.name);
    table.feature.insert(table.feature.end(), object.feature.begin(), object.feature.end());
    table.category.push_back(object.category);
    table.category_input.insert(table.category_input.end(), object.category_input.begin(),
                                object.category_input.end());
  }
  return table;
}

ShapeRows::ShapeRows(const ShapeTable& table, const RunningMoments& moments, double clip,
                     int num_categories)
    : objects_(table.objects()), feature_(table.feature), category_(objects_ * num_categories) {
  DEX_CHECK_EQ(feature_.size(), objects_ * moments.mean.size());
  Normalize(moments, clip, objects_, table.feature.data(), feature_.data());
  if (!table.category_input.empty()) {
    DEX_CHECK_EQ(table.category_input.size(), category_.size());
    category_ = table.category_input;
    return;
  }
  for (std::int64_t k = 0; k < objects_; ++k) {
    DEX_CHECK_LT(table.category[k], num_categories);
    category_[k * num_categories + table.category[k]] = 1;
  }
}

}  // namespace dexremoe
