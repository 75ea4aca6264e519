// What policies see of an object's category.
#include "policy/shape_table.h"

#include <gtest/gtest.h>

namespace dexremoe {
namespace {

TaskObject Object(int category, std::vector<float> category_input) {
  TaskObject object;
  object.category = category;
  object.feature.assign(kShapeFeatureSize, 0.5f);
  object.category_input = std::move(category_input);
  return object;
}

// The category columns of all objects.
std::vector<float> Categories(const std::vector<TaskObject>& objects) {
  const ShapeRows rows(MakeShapeTable(objects), RunningMoments(kShapeFeatureSize), 5,
                       kNumCategories);
  const ShapeInputs<float> inputs = rows.inputs();
  return {inputs.category, inputs.category + inputs.objects * kNumCategories};
}

TEST(ShapeTable, AOneHotInputIsWhatTheLabelGives) {
  EXPECT_EQ(Categories({Object(2, {}), Object(5, {})}),
            Categories({Object(0, {0, 0, 1, 0, 0, 0}), Object(0, {0, 0, 0, 0, 0, 1})}));
}

TEST(ShapeTable, ProbabilitiesTakeThePlaceOfTheLabel) {
  const std::vector<float> soft = {0.25f, 0, 0, 0.5f, 0.125f, 0.125f};
  EXPECT_EQ(Categories({Object(1, soft)}), soft);
}

}  // namespace
}  // namespace dexremoe
