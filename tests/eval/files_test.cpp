#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "eval/embedding.h"
#include "eval/report.h"
#include "eval/trace.h"
#include "sample_eval.h"

namespace dexremoe {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(EvalFile, ComesBackWhole) {
  const std::string path = Path("eval.h5");
  const EvalFile eval = SampleEval(5);
  WriteEval(path, eval, {"test", "", 1, {}});
  const EvalFile back = ReadEval(path);
  EXPECT_EQ(back.policy, "base.h5");
  EXPECT_EQ(back.engine, "ode");
  EXPECT_EQ(back.substeps, 2);
  ASSERT_EQ(back.objects.size(), 8u);
  EXPECT_EQ(back.objects[7].split, "ood");
  ASSERT_EQ(back.runs.size(), 2u);
  for (int r = 0; r < 2; ++r) {
    EXPECT_EQ(back.runs[r].tolerance, eval.runs[r].tolerance);
    ASSERT_EQ(back.runs[r].episodes.size(), eval.runs[r].episodes.size());
    for (std::size_t i = 0; i < eval.runs[r].episodes.size(); ++i) {
      const EpisodeRecord &a = eval.runs[r].episodes[i], &b = back.runs[r].episodes[i];
      EXPECT_EQ(a.object, b.object);
      EXPECT_EQ(a.episode, b.episode);
      EXPECT_EQ(a.length, b.length);
      EXPECT_EQ(a.successes, b.successes);
      EXPECT_EQ(a.end, b.end);
      EXPECT_EQ(a.still, b.still);
      EXPECT_EQ(a.total_reward, b.total_reward);
      EXPECT_EQ(a.mean_angle, b.mean_angle);
      EXPECT_EQ(a.mean_distance, b.mean_distance);
    }
    // The stored metrics are those of the stored episodes.
    const Metrics again = ComputeMetrics(back.runs[r].episodes, {100, eval.seed});
    for (int k = 0; k < kNumMetrics; ++k) {
      EXPECT_EQ(back.runs[r].metrics.values[k].value, again.values[k].value);
      EXPECT_EQ(back.runs[r].metrics.values[k].low, again.values[k].low);
    }
    for (int o = 0; o < 8; ++o) {
      EXPECT_EQ(back.runs[r].metrics.objects[o].values[0].high, again.objects[o].values[0].high);
      EXPECT_EQ(back.runs[r].metrics.objects[o].episodes, 10);
    }
  }
}

TEST(EvalFile, OfBeforeJamsWereKnownIsReadAndSaysSo) {
  const std::string path = Path("old_eval.h5");
  EvalFile eval = SampleEval(5);
  eval.jams_known = false;  // then the file has no column for them
  WriteEval(path, eval, {"test", "", 1, {}});
  const EvalFile back = ReadEval(path);
  EXPECT_FALSE(back.jams_known);
  for (const EpisodeRecord& e : back.runs[0].episodes) EXPECT_EQ(e.still, -1);
  EXPECT_THAT(ReportOf(back), HasSubstr("jams                    ?"));
  EXPECT_THAT(ReportOf(SampleEval(5)), Not(HasSubstr("?")));
}

TEST(EvalFile, SplitsAndTolerancesAreFound) {
  const EvalFile eval = SampleEval(5);
  ASSERT_NE(FindRun(eval, 0.1), nullptr);
  EXPECT_EQ(FindRun(eval, 0.2), nullptr);
  EXPECT_EQ(EpisodesOfSplit(eval, eval.runs[0], "train").size(), 60u);
  EXPECT_EQ(EpisodesOfSplit(eval, eval.runs[0], "ood").size(), 20u);
  EXPECT_EQ(EpisodesOfSplit(eval, eval.runs[0], "all").size(), 80u);
}

TEST(Report, ShowsEveryObjectToleranceAndMetric) {
  const EvalFile eval = SampleEval(5);
  const std::string text = ReportOf(eval);
  for (const EvalObject& object : eval.objects) EXPECT_THAT(text, HasSubstr(object.name));
  for (const char* word : {"tolerance 0.4 rad", "tolerance 0.1 rad", "S_min", "S_5-", "S_mean",
                           "falls", "jams", "engine ode with 2 substeps", "seed 1"})
    EXPECT_THAT(text, HasSubstr(word));
}

TraceFile SampleTrace(int experts) {
  TraceFile trace;
  trace.policy = "gate.h5";
  trace.tolerance = 0.4;
  trace.joint_names = {"j1", "j2"};
  for (int e = 0; e < experts; ++e) trace.expert_names.push_back("e" + std::to_string(e));
  for (const int length : {3, 1}) {
    EpisodeTrace& e = trace.episodes.emplace_back();
    e.object = "duck";
    e.category = "animal";
    e.episode = static_cast<std::uint64_t>(length);
    e.scale = 0.9;
    e.end = "fall";
    e.successes = length - 1;
    for (int t = 0; t < length; ++t) {
      for (int k = 0; k < 2; ++k) {
        e.joint_position.push_back(t + 0.1 * k);
        e.action.push_back(static_cast<float>(-t));
      }
      for (int k = 0; k < 3; ++k) e.object_position.push_back(t * k);
      for (int k = 0; k < 4; ++k) {
        e.object_rotation.push_back(k == 0);
        e.goal_rotation.push_back(k == 1);
      }
      e.angle.push_back(3.0 - t);
      e.success.push_back(static_cast<std::uint8_t>(t > 0));
      for (int k = 0; k < experts; ++k) e.gate.push_back(1.0f / static_cast<float>(experts));
    }
  }
  return trace;
}

TEST(Trace, ComesBackWithAndWithoutAGate) {
  for (const int experts : {0, 4}) {
    const std::string path = Path("trace.h5");
    const TraceFile trace = SampleTrace(experts);
    WriteTrace(path, trace, {"test", "", 1, {}});
    const TraceFile back = ReadTrace(path);
    EXPECT_EQ(back.joint_names, trace.joint_names);
    EXPECT_EQ(back.expert_names, trace.expert_names);
    ASSERT_EQ(back.episodes.size(), 2u);
    for (int i = 0; i < 2; ++i) {
      const EpisodeTrace &a = trace.episodes[i], &b = back.episodes[i];
      EXPECT_EQ(a.object, b.object);
      EXPECT_EQ(a.episode, b.episode);
      EXPECT_EQ(a.end, b.end);
      EXPECT_EQ(a.scale, b.scale);
      EXPECT_EQ(a.successes, b.successes);
      EXPECT_EQ(a.joint_position, b.joint_position);
      EXPECT_EQ(a.object_position, b.object_position);
      EXPECT_EQ(a.object_rotation, b.object_rotation);
      EXPECT_EQ(a.goal_rotation, b.goal_rotation);
      EXPECT_EQ(a.angle, b.angle);
      EXPECT_EQ(a.success, b.success);
      EXPECT_EQ(a.action, b.action);
      EXPECT_EQ(a.gate, b.gate);
    }
  }
}

TEST(Trace, AnotherFormatIsRefused) {
  const std::string path = Path("not_a_trace.h5");
  WriteEval(path, SampleEval(5), {"test", "", 1, {}});
  EXPECT_THAT(Message([&] { ReadTrace(path); }), HasSubstr("expected format dexremoe.trace"));
}

TEST(LogRatios, AreCentredAndInvariantToScale) {
  const std::vector<double> a = LogRatios({0.5f, 0.25f, 0.25f}, 3);
  const std::vector<double> b = LogRatios({1.0f, 0.5f, 0.5f}, 3);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], 1e-12);
  EXPECT_NEAR(a[0] + a[1] + a[2], 0, 1e-12);
  EXPECT_NEAR(a[0] - a[1], std::log(2), 1e-12);
  for (const double x : LogRatios({1, 0, 0}, 3)) EXPECT_TRUE(std::isfinite(x));
}

TEST(Embedding, ObjectsThatMixAlikeShareAClusterAndTheFileComesBack) {
  // Two kinds of mixtures, four objects each, 20 turns of every object.
  std::vector<float> weight;
  std::vector<std::int32_t> row_object;
  std::vector<EmbeddedObject> objects(8);
  Rng rng(1, Stream::kTest);
  for (int o = 0; o < 8; ++o) {
    objects[o].name = "o" + std::to_string(o);
    objects[o].category = "shoe";
    for (int k = 0; k < 20; ++k) {
      row_object.push_back(o);
      std::array<double, 3> w = {std::exp(0.1 * rng.Normal() + (o < 4 ? 2 : 0)),
                                 std::exp(0.1 * rng.Normal()),
                                 std::exp(0.1 * rng.Normal() + (o < 4 ? 0 : 2))};
      for (const double x : w) weight.push_back(static_cast<float>(x / (w[0] + w[1] + w[2])));
    }
  }
  ThreadPool pool(2);
  TsneOptions options;
  options.iterations = 400;
  const Embedding map = EmbedWeights(weight, 3, row_object, objects, options, 1, pool);
  EXPECT_EQ(map.clusters, 2);
  for (int o = 0; o < 8; ++o) {
    EXPECT_EQ(map.objects[o].cluster, map.objects[o < 4 ? 0 : 4].cluster);
    EXPECT_EQ(map.objects[o].expert, o < 4 ? 0 : 2);
  }
  EXPECT_NE(map.objects[0].cluster, map.objects[4].cluster);
  EXPECT_GT(map.silhouette, 0.5);
  EXPECT_GT(map.trustworthiness, 0.8);
  const std::string path = Path("tsne.h5");
  WriteEmbedding(path, map, {"test", "", 1, {}});
  const Embedding back = ReadEmbedding(path);
  EXPECT_EQ(back.position, map.position);
  EXPECT_EQ(back.weight, map.weight);
  EXPECT_EQ(back.row_object, map.row_object);
  EXPECT_EQ(back.kl, map.kl);
  EXPECT_EQ(back.objects[5].name, "o5");
  EXPECT_EQ(back.objects[5].x, map.objects[5].x);
}

}  // namespace
}  // namespace dexremoe
