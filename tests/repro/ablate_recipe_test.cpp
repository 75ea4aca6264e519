// What `make ablate-recipe` trains and tabulates, read from what make would run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "run_make.h"

namespace dexremoe {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class AblateRecipe : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("dexremoe_ablate_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "meshes/vehicle");
    std::ofstream(folder_ / "meshes/vehicle/cube.ply") << "nothing is read of this";
  }
  void TearDown() override { fs::remove_all(folder_); }

  Outcome Plan(const std::string& words) const {
    const std::string folder = folder_.string();
    return Make("-n --no-print-directory EXPERIMENT=1 OBJECTS=" + folder + "/meshes OUT=" + folder +
                "/run " + words);
  }
  // Lines of the plan for `switches` and seeds 1 and 2 that start `tool`.
  std::vector<std::string> Lines(const std::string& tool, const std::string& switches) const {
    const Outcome plan = Plan("ablated-recipe SWITCHES='" + switches + "'");
    EXPECT_EQ(plan.code, 0) << plan.text;
    std::vector<std::string> lines;
    std::istringstream text(plan.text);
    for (std::string line; std::getline(text, line);)
      if (line.find("bin/" + tool + " ") != std::string::npos) lines.push_back(line);
    return lines;
  }

  fs::path folder_;
};

// The words of a line that start with `option`, parted at commas.
std::vector<std::string> ListOf(const std::string& line, const std::string& option) {
  const std::size_t begin = line.find(option);
  if (begin == std::string::npos) return {};
  std::istringstream words(line.substr(begin + option.size()));
  std::string list;
  words >> list;
  std::istringstream parts(list);
  std::vector<std::string> found;
  for (std::string part; std::getline(parts, part, ',');) found.push_back(part);
  return found;
}

TEST_F(AblateRecipe, UnknownSwitchIsNamedBesideTheKnown) {
  const Outcome outcome = Plan("ablate-recipe SWITCHES='all no_gravity'");
  EXPECT_NE(outcome.code, 0);
  EXPECT_THAT(outcome.text, HasSubstr("found no_gravity"));
  EXPECT_THAT(outcome.text, HasSubstr("no_goal_vector"));
}

TEST_F(AblateRecipe, EveryFileOfTheTableHasItsLabel) {
  const auto lines = Lines("tabulate", "all no_clock");
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_THAT(ListOf(lines[0], "--labels="),
              ElementsAre("all", "all", "all:seed1", "all:seed2", "no_clock", "no_clock",
                          "no_clock:seed1", "no_clock:seed2"));
  std::vector<std::string> names;
  for (const fs::path file : ListOf(lines[0], "--eval=")) names.push_back(file.filename());
  EXPECT_THAT(names, ElementsAre("all-1.eval.h5", "all-2.eval.h5", "all-1.eval.h5", "all-2.eval.h5",
                                 "no_clock-1.eval.h5", "no_clock-2.eval.h5", "no_clock-1.eval.h5",
                                 "no_clock-2.eval.h5"));
}

TEST_F(AblateRecipe, WithoutSwitchesNamedEachTrainsSomethingElse) {
  const Outcome plan = Plan("ablated-recipe ABLATE_SEEDS=1");
  EXPECT_EQ(plan.code, 0) << plan.text;
  std::istringstream text(plan.text);
  std::set<std::string> options;
  std::size_t trainings = 0;
  for (std::string line; std::getline(text, line);) {
    if (line.find("bin/train_base ") == std::string::npos) continue;
    ++trainings;
    const std::size_t own = line.find("--workers="), end = line.find("--samples=");
    ASSERT_LT(own, end) << line;
    options.insert(line.substr(own, end - own));
  }
  EXPECT_GT(trainings, 10u);
  EXPECT_EQ(options.size(), trainings);
}

// An input left out in training is left out in evaluation, too.
TEST_F(AblateRecipe, TheTaskOfASwitchIsEvaluated) {
  const std::string inputs =
      "--task.extra_inputs=goal_vector,joint_speed,tip_position,tip_contact ";
  for (const char* tool : {"train_base", "evaluate"}) {
    const auto lines = Lines(tool, "no_clock");
    ASSERT_EQ(lines.size(), 2u) << tool;
    for (const std::string& line : lines) EXPECT_THAT(line, HasSubstr(inputs)) << tool;
  }
}

}  // namespace
}  // namespace dexremoe
