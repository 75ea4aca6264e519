// The figure of an ablation holds the table's numbers, and figures name what is missing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "eval/plots.h"
#include "eval/tables.h"
#include "sample_eval.h"

namespace dexremoe {
namespace {

using ::testing::HasSubstr;

TEST(AblationFigure, BarsAreTheTablesNumbersOfTheTrainingObjects) {
  const std::vector<EvaluatedMethod> methods = {{"4 experts", SampleEval(9)},
                                                {"6 experts", SampleEval(5)}};
  const Figure figure = AblationFigure(methods, 0.4);
  const auto tables =
      MakeTables({{"4 experts", {methods[0].eval}}, {"6 experts", {methods[1].eval}}}, {}, {}, {});
  std::istringstream data(figure.data);
  std::string line;
  for (std::size_t m = 0; m < 2; ++m)
    for (std::size_t k = 0; k < kNumPaperMetrics;) {
      ASSERT_TRUE(std::getline(data, line));
      if (line.empty() || line[0] == '#') continue;
      std::istringstream fields(line);
      double place = 0, value = 0, low = 0, high = 0;
      std::string metric;
      fields >> place >> metric >> value >> low >> high;
      EXPECT_EQ(metric, tables[0].columns[k].name());
      const Estimate& expected = tables[0].rows[m].values[k];
      EXPECT_NEAR(value, expected.value, 1e-4);
      EXPECT_NEAR(low, expected.low, 1e-4);
      EXPECT_NEAR(high, expected.high, 1e-4);
      EXPECT_NEAR(place, static_cast<double>(k), 0.4);
      ++k;
    }
}

TEST(AblationFigure, AMethodWithoutTheToleranceIsNamed) {
  EXPECT_THAT(Message([&] {
                AblationFigure({{"cloud", SampleEval(5)}}, 0.2);
              }),
              HasSubstr("cloud: expected an evaluation at tolerance 0.2 rad"));
}

TEST(NoteMissing, NamesStandInTheFigureAndItsDataAndNothingWithoutNames) {
  const Figure plain = AblationFigure({{"full", SampleEval(5)}}, 0.4);
  Figure figure = plain;
  NoteMissing({}, figure);
  EXPECT_EQ(figure.script, plain.script);
  EXPECT_EQ(figure.data, plain.data);
  NoteMissing({"cloud", "8 experts"}, figure);
  EXPECT_THAT(figure.script, HasSubstr("\"missing: cloud, 8 experts\""));
  EXPECT_THAT(figure.data, HasSubstr("# missing: cloud, 8 experts\n"));
}

}  // namespace
}  // namespace dexremoe
