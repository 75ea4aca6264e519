#include "eval/ranking.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "eval/evaluation.h"
#include "sample_eval.h"

namespace dexremoe {
namespace {

using ::testing::HasSubstr;

EpisodeRecord Ended(int object, int number, int successes, int length, int still) {
  EpisodeRecord e;
  e.object = object;
  e.episode = static_cast<std::uint64_t>(number);
  e.successes = successes;
  e.length = length;
  e.end = length < 600 ? EpisodeEnd::kFall : EpisodeEnd::kTimeout;
  e.still = still;
  return e;
}

// Six objects with S = 0, 1, ..., 5 in four episodes: two falls, a jam, one that turns.
EvalFile Staircase() {
  EvalFile eval;
  eval.policy = "base.h5";
  EvalRun& run = eval.runs.emplace_back();
  run.tolerance = 0.4;
  for (int o = 0; o < 6; ++o) {
    eval.objects.push_back({"object_" + std::to_string(o), "shoe", o < 5 ? "train" : "ood"});
    for (const EpisodeRecord& e : {Ended(o, 0, o, 600, 0), Ended(o, 1, o, 300, 0),
                                   Ended(o, 2, o, 100, 90), Ended(o, 3, o, 600, 61)})
      run.episodes.push_back(e);
  }
  run.metrics = ComputeMetrics(run.episodes, {20, 1});
  return eval;
}

TEST(Ranking, ListsWorstAscendingAndBestDescendingOfTheSplit) {
  const EvalFile eval = Staircase();
  const Ranking ranking = RankObjects(eval, eval.runs[0], "train", 2);
  ASSERT_EQ(ranking.worst.size(), 2u);
  ASSERT_EQ(ranking.best.size(), 2u);
  EXPECT_EQ(ranking.worst[0].name, "object_0");
  EXPECT_EQ(ranking.worst[1].name, "object_1");
  EXPECT_EQ(ranking.best[0].name, "object_4");
  EXPECT_EQ(ranking.best[1].successes.value, 3);
  EXPECT_EQ(ranking.worst[0].shares.fall, 0.5);
  EXPECT_EQ(ranking.worst[0].shares.jam, 0.25);
}

TEST(Ranking, NoObjectIsBothBestAndWorst) {
  const EvalFile eval = Staircase();
  EXPECT_EQ(RankObjects(eval, eval.runs[0], "train", 5).worst.size(), 2u);
  EXPECT_EQ(RankObjects(eval, eval.runs[0], "all", 5).best.size(), 3u);
  EXPECT_THROW(RankObjects(eval, eval.runs[0], "ood", 5), Error);
}

TEST(Ranking, TablesShowHowEpisodesEndOrThatItIsNotKnown) {
  EvalFile eval = Staircase();
  const Ranking known = RankObjects(eval, eval.runs[0], "train", 1);
  EXPECT_THAT(MarkdownOf(known),
              HasSubstr("| object_0 | shoe | train | 0.00 [0.00, 0.00] | 0.50 | 0.25 | 0.25 |"));
  EXPECT_THAT(CsvOf(known), HasSubstr("best,1,object_4,shoe,train,4,4,4,4,0.5,0.25,0.25\n"));
  eval.jams_known = false;
  for (EpisodeRecord& e : eval.runs[0].episodes) e.still = -1;
  const Ranking unknown = RankObjects(eval, eval.runs[0], "train", 1);
  EXPECT_THAT(MarkdownOf(unknown), HasSubstr("| 0.50 | ? | 0.50 |"));
  EXPECT_THAT(CsvOf(unknown), HasSubstr("0.5,nan,0.5\n"));
}

// Falls are the more frequent failure; of two the longer counts as their median.
TEST(ChooseEpisodes, TypicalIsTheMedianOfTheMostFrequentFailureOfEachObject) {
  const auto jobs = ChooseEpisodes(Staircase().runs[0], 4, "typical");
  ASSERT_EQ(jobs.size(), 4u);
  for (int o = 0; o < 4; ++o) {
    EXPECT_EQ(jobs[o].object, o);  // fewest successes first
    EXPECT_EQ(jobs[o].episode, 1u);
  }
  EvalRun turning;
  turning.episodes = {Ended(0, 7, 3, 600, 0)};
  turning.metrics = ComputeMetrics(turning.episodes, {0, 1});
  EXPECT_EQ(ChooseEpisodes(turning, 5, "typical")[0].episode, 7u);
}

}  // namespace
}  // namespace dexremoe
