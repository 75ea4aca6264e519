// What evaluation tells policies of an object's category.
#include <gtest/gtest.h>

#include "eval/evaluation.h"
#include "sample_eval.h"
#include "shape/shape_files.h"

namespace dexremoe {
namespace {

class CategoryInput : public testing::Test {
 protected:
  void SetUp() override {
    for (int i = 0; i < 2; ++i) {
      const std::string folder = Path("category_input_" + std::to_string(i));
      std::vector<float> logits(6, 0.0f);
      logits[i == 0 ? 4 : 1] = 2;
      WriteShape(folder + "/shape.h5", {std::vector<float>(kShapeFeatureSize, 0.0f), logits},
                 {"test", "", 1, {}});
      entries_.push_back({"object", "shoe", "train", "", folder, ""});
      objects_.emplace_back().category = 3;
    }
  }
  std::vector<ObjectEntry> entries_;
  std::vector<TaskObject> objects_;
};

TEST_F(CategoryInput, OfALabelIsLeftToTheLabel) {
  SetCategoryInput("label", entries_, objects_);
  for (const TaskObject& object : objects_) EXPECT_TRUE(object.category_input.empty());
}

TEST_F(CategoryInput, PredictedIsTheLikeliestAloneAndTheLabelStays) {
  SetCategoryInput("predicted", entries_, objects_);
  EXPECT_EQ(objects_[0].category_input, (std::vector<float>{0, 0, 0, 0, 1, 0}));
  EXPECT_EQ(objects_[1].category_input, (std::vector<float>{0, 1, 0, 0, 0, 0}));
  EXPECT_EQ(objects_[0].category, 3);
}

TEST_F(CategoryInput, SoftIsTheSoftmaxOfTheLogits) {
  SetCategoryInput("soft", entries_, objects_);
  const double sum = std::exp(2.0) + 5;
  for (int c = 0; c < 6; ++c)
    EXPECT_NEAR(objects_[0].category_input[c], (c == 4 ? std::exp(2.0) : 1) / sum, 1e-6);
}

TEST_F(CategoryInput, NeedsTheShapeFile) {
  entries_[1].folder += "_absent";
  EXPECT_NE(Message([&] { SetCategoryInput("soft", entries_, objects_); }).find("_absent/shape.h5"),
            std::string::npos);
}

TEST(EvalFile, KeepsWhatThePolicyWasToldOfCategories) {
  EvalFile eval = SampleEval(10);
  eval.category_input = "soft";
  WriteEval(Path("soft.h5"), eval, {"test", "", 1, {}});
  EXPECT_EQ(ReadEval(Path("soft.h5")).category_input, "soft");
}

}  // namespace
}  // namespace dexremoe
