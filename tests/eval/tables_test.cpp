#include "eval/tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "io/atomic_file.h"
#include "io/csv.h"
#include "sample_eval.h"

namespace dexremoe {
namespace {

using ::testing::HasSubstr;

TEST(PaperNumbers, TheTableHasAllMethodsSplitsAndMetrics) {
  const auto numbers = ReadPaperNumbers("data/paper_tables.csv");
  EXPECT_EQ(numbers.size(), 10u * 2 * 5);
  const auto find = [&](const std::string& method, const std::string& split, const std::string& m) {
    for (const PaperNumber& n : numbers)
      if (n.method == method && n.split == split && n.metric == m) return n.value;
    return double{NAN};
  };
  EXPECT_EQ(find("DexReMoE", "train", "s_mean"), 19.62);
  EXPECT_EQ(find("MMoE", "ood", "s_worst5"), 8.67);
  // In every row: worst five <= mean <= best five <= max, and min <= worst five.
  for (const PaperNumber& n : numbers) {
    EXPECT_LE(find(n.method, n.split, "s_min"), find(n.method, n.split, "s_worst5"));
    EXPECT_LE(find(n.method, n.split, "s_worst5"), find(n.method, n.split, "s_mean"));
    EXPECT_LE(find(n.method, n.split, "s_mean"), find(n.method, n.split, "s_best5"));
    EXPECT_LE(find(n.method, n.split, "s_best5"), find(n.method, n.split, "s_max"));
  }
}

TEST(PaperNumbers, UnknownMetricsAreNamed) {
  const std::string path = Path("paper.csv");
  WriteFile(path, "table,method,split,metric,value\n1,DR,train,s_medium,3\n");
  EXPECT_THAT(Message([&] { ReadPaperNumbers(path); }), HasSubstr("s_medium"));
  WriteFile(path, "table,method,split,metric,value\n1,DR,test,s_min,3\n");
  EXPECT_THAT(Message([&] { ReadPaperNumbers(path); }), HasSubstr("found 'test'"));
}

TEST(Tables, PaperRowsStandBelowOursAtTheirToleranceOnly) {
  const std::vector<MethodResults> methods = {{"Base", {SampleEval(5)}}, {"Ours", {SampleEval(9)}}};
  const auto tables = MakeTables(methods, ReadPaperNumbers("data/paper_tables.csv"), {}, {50, 1});
  ASSERT_EQ(tables.size(), 4u);  // two splits, two tolerances
  for (const ResultTable& table : tables) {
    EXPECT_EQ(table.rows.size(), table.tolerance == 0.4 ? 12u : 2u);
    EXPECT_EQ(table.rows[1].label, "Ours");
    EXPECT_FALSE(table.rows[1].paper);
    EXPECT_THAT(table.caption, HasSubstr(table.split == "train" ? "6 training" : "2 out-of"));
    EXPECT_THAT(table.caption, HasSubstr("1 seed;"));
    EXPECT_THAT(table.caption, HasSubstr("engine ode with 2 substeps"));
  }
  EXPECT_EQ(tables[0].rows[11].label, "DexReMoE");
  EXPECT_EQ(tables[0].rows[11].values[4].value, 19.62);
}

TEST(Tables, MarkdownColumnsLineUp) {
  const std::vector<MethodResults> methods = {{"Bäse", {SampleEval(5)}},
                                              {"A much longer name", {SampleEval(9)}}};
  const std::string text = MarkdownOf(MakeTables(methods, {}, {}, {50, 1}));
  std::size_t width = 0, lines = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    const std::string line = text.substr(at, end - at);
    at = end + 1;
    if (line.empty() || line[0] != '|') {
      width = 0;
      continue;
    }
    std::size_t shown = 0;
    for (const char c : line) shown += (c & 0xC0) != 0x80;
    if (width == 0) width = shown;
    EXPECT_EQ(shown, width) << line;
    ++lines;
  }
  EXPECT_EQ(lines, 4u * 4);
}

TEST(Tables, LatexEscapesAndCsvIsATable) {
  const std::vector<MethodResults> methods = {{"Base_1 & 5%", {SampleEval(5)}}};
  const auto tables = MakeTables(methods, ReadPaperNumbers("data/paper_tables.csv"), {}, {50, 1});
  const std::string latex = LatexOf(tables);
  EXPECT_THAT(latex, HasSubstr("Base\\_1 \\& 5\\%"));
  EXPECT_THAT(latex, HasSubstr("\\toprule"));
  EXPECT_THAT(latex, HasSubstr("$\\bar S_{5-}$"));
  const std::string path = Path("table.csv");
  WriteFile(path, CsvOf(tables));
  const CsvTable csv = CsvTable::Read(path);
  EXPECT_EQ(csv.num_rows(), 4u * 8 + 2 * 10 * 5);
  WriteFile(path, ObjectCsvOf(methods, {50, 1}));
  const CsvTable objects = CsvTable::Read(path);
  EXPECT_EQ(objects.num_rows(), 16u);  // eight objects at two tolerances
  EXPECT_EQ(objects.Numbers("episodes")[0], 10);
}

TEST(Tables, SeedsOfAMethodArePooled) {
  const EvalFile a = SampleEval(5, 1), b = SampleEval(9, 2);
  const auto tables = MakeTables({{"Both", {a, b}}}, {}, {}, {50, 1});
  EXPECT_THAT(tables[0].caption, HasSubstr("120 episodes a method, 2 seeds"));
  double mean = 0;
  for (int o = 0; o < 6; ++o)
    mean += (a.runs[0].metrics.objects[o].values[0].value +
             b.runs[0].metrics.objects[o].values[0].value) /
            12;
  EXPECT_NEAR(tables[0].rows[0].values[4].value, mean, 1e-12);
}

// A column of a category is what a table of its objects alone says; together they are all objects.
TEST(Tables, CategoriesHaveColumnsOfTheirOwn) {
  EvalFile eval = SampleEval(5);
  for (int o : {0, 1, 7}) eval.objects[o].category = "shoe";
  const auto tables = MakeTables({{"Ours", {eval}}}, {}, {.categories = true}, {50, 1});
  ASSERT_EQ(tables.size(), 4u);
  for (const ResultTable& table : tables) {
    ASSERT_EQ(table.columns.size(), 3u);
    EXPECT_EQ(table.columns[0].label(), "shoe");
    EXPECT_EQ(table.columns[1].name(), "s_mean:train");
    EXPECT_EQ(table.columns[2].name(), "s_mean");
    const auto& values = table.rows[0].values;
    const double shoes = table.split == "train" ? 2 : 1, trains = table.split == "train" ? 4 : 1;
    EXPECT_NEAR((shoes * values[0].value + trains * values[1].value) / (shoes + trains),
                values[2].value, 1e-12);
  }
  EvalFile shoes = eval;
  std::erase_if(shoes.runs[0].episodes, [](const EpisodeRecord& e) { return e.object > 1; });
  const auto alone = MakeTables({{"Ours", {shoes}}}, {}, {}, {50, 1});
  EXPECT_EQ(tables[0].rows[0].values[0].value, alone[0].rows[0].values[4].value);
  EXPECT_EQ(tables[0].rows[0].values[0].low, alone[0].rows[0].values[4].low);
  EXPECT_THAT(MarkdownOf(tables), HasSubstr(" shoe |"));
  EXPECT_THAT(LatexOf(tables), HasSubstr("Method & shoe & train & "));
}

TEST(Tables, MethodsOfOtherObjectsOrEnginesAreRefused) {
  EvalFile other = SampleEval(5);
  other.objects[2].name = "stranger";
  EXPECT_THAT(Message([&] {
                MakeTables({{"A", {SampleEval(5)}}, {"B", {other}}}, {}, {}, {1, 1});
              }),
              HasSubstr("B: expected the same train objects as A"));
  other = SampleEval(5);
  other.substeps = 4;
  EXPECT_THAT(Message([&] {
                MakeTables({{"A", {SampleEval(5)}}, {"B", {other}}}, {}, {}, {1, 1});
              }),
              HasSubstr("substeps"));
}

TEST(Tables, AMethodWithoutEvaluationsIsMissingInEveryTable) {
  const std::vector<MethodResults> methods = {
      {"Gone", {}}, {"Base", {SampleEval(5)}}, {"Also gone", {}}};
  const auto tables = MakeTables(methods, {}, {}, {50, 1});
  ASSERT_EQ(tables.size(), 4u);
  for (const ResultTable& table : tables) {
    ASSERT_EQ(table.rows.size(), 3u);
    EXPECT_TRUE(table.rows[0].missing && table.rows[2].missing);
    EXPECT_FALSE(table.rows[1].missing);
    EXPECT_THAT(table.caption, HasSubstr("1 seed;"));  // counts what is there alone
  }
  EXPECT_THAT(MarkdownOf(tables), HasSubstr("| Gone "));
  EXPECT_THAT(MarkdownOf(tables), HasSubstr(" missing |"));
  EXPECT_THAT(LatexOf(tables), HasSubstr("Also gone & \\multicolumn{8}{c}{missing} \\\\"));
  EXPECT_THAT(CsvOf(tables), HasSubstr("train,0.4,missing,Gone,s_min,,,\n"));
  // The others' numbers do not depend on who is missing.
  const auto alone = MakeTables({methods[1]}, {}, {}, {50, 1});
  for (std::size_t c = 0; c < alone[0].columns.size(); ++c)
    EXPECT_EQ(tables[0].rows[1].values[c].value, alone[0].rows[0].values[c].value);
}

TEST(Tables, AllMissingIsAnError) {
  EXPECT_EQ(Message([&] {
              MakeTables({{"A", {}}, {"B", {}}}, {}, {}, {1, 1});
            }),
            "expected an evaluation of at least one of 2 methods, found none");
}

TEST(Tables, RowsMayBeEngines) {
  EvalFile other = SampleEval(5);
  other.engine = "mujoco";
  other.substeps = 16;
  const auto tables =
      MakeTables({{"A", {SampleEval(5)}}, {"B", {other}}}, {}, {.engines = true}, {1, 1});
  EXPECT_THAT(tables[0].caption, HasSubstr("mujoco with 16 substeps"));
}

}  // namespace
}  // namespace dexremoe
