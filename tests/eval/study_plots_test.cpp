#include "eval/study_plots.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "sample_eval.h"

namespace dexremoe {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

// Object o of a method has S = skill[o] in all of its episodes; 0, 1 and 2 are for training.
EvaluatedMethod Method(const std::string& label, const std::vector<int>& skill) {
  EvaluatedMethod method{label, {}};
  EvalRun& run = method.eval.runs.emplace_back();
  run.tolerance = 0.4;
  for (int o = 0; o < static_cast<int>(skill.size()); ++o) {
    method.eval.objects.push_back(
        {std::string(1, static_cast<char>('a' + o)), "shoe", o < 3 ? "train" : "ood"});
    for (int e = 0; e < 2; ++e) {
      EpisodeRecord r;
      r.object = o;
      r.length = 600;
      r.successes = skill[o];
      run.episodes.push_back(r);
    }
  }
  run.metrics = ComputeMetrics(run.episodes, {20, 1});
  return method;
}

std::vector<double> Column(const std::string& data) {
  std::vector<double> first;
  std::istringstream lines(data);
  for (std::string line; std::getline(lines, line);)
    if (!line.empty() && line[0] != '#') first.push_back(std::stod(line));
  return first;
}

TEST(StudyFigure, JoinsTheMethodsOfALabelInOrderOfX) {
  const std::vector<EvaluatedMethod> methods = {Method("a", {1, 2}), Method("b", {1, 1}),
                                                Method("a", {0, 1})};
  const Figure figure = StudyFigure(methods, {0.8, 0.6, 0.7}, "size", 0.4, {"c"});
  EXPECT_THAT(Column(figure.data), ElementsAre(0.7, 0.8, 0.6));
  EXPECT_THAT(figure.script, HasSubstr("\"c\""));
  EXPECT_THROW(StudyFigure(methods, {1, 2, 3}, "size", 0.1, {}), Error);
}

TEST(SortedFigure, ShowsTrainingObjectsInAscendingOrderUnderTheLastMethod) {
  const Figure figure =
      SortedFigure({Method("base", {1, 2, 3, 9}), Method("ours", {5, 3, 4, 9})}, 0.4, {});
  EXPECT_THAT(figure.data, HasSubstr("1 \"b\" 2 2 2\n2 \"c\" 3 3 3\n3 \"a\" 1 1 1\n"));
  EXPECT_THAT(figure.data, Not(HasSubstr("\"d\"")));
}

TEST(ObjectPanels, AreDrawnWithTheMethodsThatAreMissing) {
  const std::vector<EvaluatedMethod> methods = {Method("base", {1, 2, 3}),
                                                Method("ours", {5, 3, 4})};
  const Figure figure = ObjectPanelsFigure(methods, 0.4, {2, 0}, {"other"});
  EXPECT_THAT(figure.data, HasSubstr("# ours\n1 \"c\" 4 4 4\n2 \"a\" 5 5 5\n"));
  EXPECT_THAT(figure.script, HasSubstr("other (missing)"));
}

TEST(HardestObjects, AreThoseOfTheOtherMethods) {
  const std::vector<EvaluatedMethod> methods = {
      Method("x", {5, 1, 0, 0}), Method("y", {0, 1, 3, 0}), Method("ours", {0, 9, 9, 0})};
  EXPECT_THAT(HardestObjects(methods, 0.4, 2), ElementsAre(1, 2));
  EXPECT_THAT(HardestObjects({methods.back()}, 0.4, 5), ElementsAre(0, 1, 2));
}

TEST(RandomOtherObjects, AreDrawnBySeedOutOfDistributionAndAscend) {
  const std::vector<EvaluatedMethod> ours = {Method("ours", {9, 9, 9, 4, 3, 2, 1, 0})};
  EXPECT_THAT(RandomOtherObjects(ours, 0.4, 10, 1), ElementsAre(7, 6, 5, 4, 3));
  std::set<std::vector<int>> choices;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const std::vector<int> chosen = RandomOtherObjects(ours, 0.4, 2, seed);
    ASSERT_EQ(chosen.size(), 2u);
    EXPECT_GT(chosen[0], chosen[1]);
    EXPECT_GE(chosen[1], 3);
    choices.insert(chosen);
    EXPECT_EQ(chosen, RandomOtherObjects(ours, 0.4, 2, seed));
  }
  EXPECT_GT(choices.size(), 4u);
  EXPECT_THROW(RandomOtherObjects({Method("ours", {1, 2})}, 0.4, 10, 1), Error);
}

TEST(StudyFigures, RefuseMethodsWithOtherObjects) {
  const std::vector<EvaluatedMethod> methods = {Method("x", {1, 2}), Method("y", {1, 2, 3})};
  EXPECT_THROW(SortedFigure(methods, 0.4, {}), Error);
  EXPECT_THROW(ObjectPanelsFigure(methods, 0.4, {0}, {}), Error);
}

}  // namespace
}  // namespace dexremoe
