#include "eval/figure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "base/error.h"
#include "base/random.h"
#include "eval/label_places.h"
#include "eval/study_plots.h"
#include "io/atomic_file.h"
#include "io/png.h"
#include "sample_eval.h"

namespace dexremoe {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class Figures : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) / ("figures_" + std::to_string(getpid()));
    fs::create_directories(folder_);
    if (std::system("gnuplot --version > /dev/null 2>&1") != 0) {
      std::printf("Skipped: figures need gnuplot\n");
      GTEST_SKIP();
    }
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string Stem(const std::string& name) const { return (folder_ / name).string(); }
  CsvTable Csv(const std::string& text) const {
    WriteFile(Stem("in.csv"), text);
    return CsvTable::Read(Stem("in.csv"));
  }
  fs::path folder_;
};

// Share of pixels that are not white.
double Ink(const std::string& path) {
  const Image image = ReadPng(path);
  std::size_t ink = 0;
  for (std::size_t k = 0; k < image.rgb.size(); k += 3)
    ink += image.rgb[k] < 250 || image.rgb[k + 1] < 250 || image.rgb[k + 2] < 250;
  return static_cast<double>(ink) / (static_cast<double>(image.width) * image.height);
}

std::string CurveText(double slope) {
  std::string text = "samples,successes_per_episode,kl,learning_rate\n";
  for (int i = 0; i < 60; ++i)
    text += std::to_string(1000 * i) + "," + std::to_string(slope * i) + ",0.01," +
            (i == 3 ? "nan" : "0.001") + "\n";
  return text;
}

TEST_F(Figures, CurvesAreDrawnInBothFormatsWithDataAndScriptBeside) {
  const Figure figure =
      CurvesFigure({{"a \"quoted\" run", Csv(CurveText(0.1))}, {"other_run", Csv(CurveText(0.2))}},
                   "samples", {}, 0.1);
  WriteFigure(Stem("sub/curves"), figure);
  for (const char* ending : {".png", ".pdf", ".dat", ".gp"})
    EXPECT_TRUE(fs::exists(Stem("sub/curves") + ending)) << ending;
  EXPECT_GT(Ink(Stem("sub/curves.png")), 0.01);
  EXPECT_THAT(ReadFile(Stem("sub/curves.pdf")).substr(0, 5), "%PDF-");
  int files = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder_ / "sub")) ++files;
  EXPECT_EQ(files, 4);  // no temporaries
}

TEST_F(Figures, EqualFiguresGiveEqualBytes) {
  const Figure figure = CurvesFigure({{"run", Csv(CurveText(0.1))}}, "samples", {"kl"}, 0);
  WriteFigure(Stem("a"), figure);
  const std::string png = ReadFile(Stem("a.png")), pdf = ReadFile(Stem("a.pdf"));
  sleep(1);  // another second on the clock
  WriteFigure(Stem("a"), figure);
  EXPECT_EQ(ReadFile(Stem("a.png")), png);
  EXPECT_EQ(ReadFile(Stem("a.pdf")), pdf);
}

TEST_F(Figures, TheScriptDrawsTheFigureAgainByItself) {
  WriteFigure(Stem("again"), CurvesFigure({{"run", Csv(CurveText(0.1))}}, "samples", {"kl"}, 0));
  fs::remove(Stem("again.png"));
  EXPECT_EQ(std::system(("cd " + folder_.string() + " && gnuplot again.gp 2> /dev/null").c_str()),
            0);
  EXPECT_TRUE(fs::exists(Stem("again.png")));
}

TEST_F(Figures, AFailingScriptIsAnErrorAndKeepsTheOldPicture) {
  WriteFile(Stem("bad.png"), "old");
  Figure figure;
  figure.script = "plot nonsense(\n";
  try {
    WriteFigure(Stem("bad"), figure);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("gnuplot failed"));
  }
  EXPECT_EQ(ReadFile(Stem("bad.png")), "old");
}

TEST_F(Figures, AMissingColumnOrEmptyTableIsNamed) {
  EXPECT_THROW(CurvesFigure({{"run", Csv("samples,other\n1,2\n")}}, "samples", {}, 0), Error);
  EXPECT_THROW(CurvesFigure({{"run", Csv("samples,kl\n")}}, "samples", {}, 0), Error);
  EXPECT_THROW(CurvesFigure({{"run", Csv("samples,kl\n1,2\n")}}, "epoch", {}, 0), Error);
}

TEST_F(Figures, SmoothingLeavesAStraightLineStraight) {
  const Figure figure =
      CurvesFigure({{"run", Csv(CurveText(0.5))}}, "samples", {"successes_per_episode"}, 0.3);
  std::istringstream lines(figure.data);
  int rows = 0;
  for (std::string line; std::getline(lines, line);) {
    double x = 0, raw = 0, smooth = 0;
    if (line.empty() || line[0] == '#') continue;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf %lf %lf", &x, &raw, &smooth), 3) << line;
    EXPECT_NEAR(raw, smooth, 1e-4);
    ++rows;
  }
  EXPECT_EQ(rows, 60);
}

EvalFile BarEval(int objects, double step) {
  EvalFile eval;
  EvalRun& run = eval.runs.emplace_back();
  run.tolerance = 0.4;
  for (int o = 0; o < objects; ++o) {
    eval.objects.push_back({"object_" + std::to_string(o), "shoe", "train"});
    for (int e = 0; e < 4; ++e) {
      EpisodeRecord r;
      r.object = o;
      r.length = 600;
      r.successes = static_cast<int>(step * (objects - o)) + e % 2;
      run.episodes.push_back(r);
    }
  }
  run.metrics = ComputeMetrics(run.episodes, {50, 1});
  return eval;
}

TEST_F(Figures, BarsAreSortedUnderTheLastMethod) {
  for (const int objects : {5, 60}) {  // bars, points
    const Figure figure =
        BarsFigure({{"Base", BarEval(objects, 1)}, {"Ours", BarEval(objects, 2)}}, 0.4);
    const std::string second = figure.data.substr(figure.data.find("# Ours"));
    EXPECT_LT(second.find("\"object_" + std::to_string(objects - 1) + '"'),
              second.find("\"object_0\""));
    WriteFigure(Stem("bars"), figure);
    EXPECT_GT(Ink(Stem("bars.png")), 0.01);
  }
  EXPECT_THROW(BarsFigure({{"Base", BarEval(5, 1)}}, 0.1), Error);
  EXPECT_THROW(BarsFigure({{"Base", BarEval(5, 1)}, {"Ours", BarEval(6, 1)}}, 0.4), Error);
}

TEST_F(Figures, GrowthJoinsTheEvaluationsOfALabelInOrderOfTheirSamples) {
  const auto after = [](double millions, double skill) {
    EvalFile eval = SampleEval(skill);
    eval.samples = static_cast<std::int64_t>(1e6 * millions);
    return eval;
  };
  const Figure figure =
      GrowthFigure({{"a", after(20, 30)}, {"b", after(5, 20)}, {"a", after(10, 10)}}, 0.4, {});
  std::vector<double> samples;
  std::istringstream lines(figure.data);
  for (std::string line; std::getline(lines, line);)
    if (!line.empty() && line[0] != '#') samples.push_back(std::stod(line));
  EXPECT_EQ(samples, (std::vector<double>{10, 20, 5}));
  WriteFigure(Stem("growth"), figure);
  EXPECT_GT(Ink(Stem("growth.png")), 0.01);
  EXPECT_THROW(GrowthFigure({{"a", after(1, 1)}}, 0.3, {}), Error);
}

TEST_F(Figures, TheMapIsDrawnInEveryColouring) {
  Embedding map;
  Rng rng(1, Stream::kTest);
  for (int o = 0; o < 7; ++o) {
    map.objects.push_back(
        {"object_" + std::to_string(o), "shoe", o % 3, o % 2, rng.Normal(), rng.Normal()});
    for (int k = 0; k < 5; ++k) {
      map.row_object.push_back(o);
      map.position.push_back(map.objects[o].x + 0.1 * rng.Normal());
      map.position.push_back(map.objects[o].y + 0.1 * rng.Normal());
    }
  }
  for (const char* color : {"cluster", "category", "expert"}) {
    WriteFigure(Stem("map"), EmbeddingFigure(map, color));
    EXPECT_GT(Ink(Stem("map.png")), 0.003);
  }
  EXPECT_THROW(EmbeddingFigure(map, "taste"), Error);
}

TEST(Labels, DoNotOverlapEachOtherOrMarkersAndStayOnTheCanvas) {
  Rng rng(3, Stream::kTest);
  LabelCanvas canvas{12, 12, 0.3, 0.1, {}};
  std::vector<LabelRequest> requests;
  for (int i = 0; i < 60; ++i)
    requests.push_back({0.2 + 11.6 * rng.Uniform(), 0.2 + 11.6 * rng.Uniform(), 0.4});
  const auto labels = PlaceLabels(requests, canvas);
  const auto apart = [](double ax, double ay, double aw, double ah, double bx, double by, double bw,
                        double bh) {
    return std::abs(ax - bx) >= (aw + bw) / 2 - 1e-9 || std::abs(ay - by) >= (ah + bh) / 2 - 1e-9;
  };
  for (int i = 0; i < 60; ++i) {
    EXPECT_GE(labels[i].x - 0.2, -1e-9);
    EXPECT_LE(labels[i].x + 0.2, 12 + 1e-9);
    for (int j = 0; j < 60; ++j) {
      EXPECT_TRUE(i == j ||
                  apart(labels[i].x, labels[i].y, 0.4, 0.3, labels[j].x, labels[j].y, 0.4, 0.3));
      EXPECT_TRUE(
          apart(labels[i].x, labels[i].y, 0.4, 0.3, requests[j].x, requests[j].y, 0.2, 0.2));
    }
  }
}

TEST(Palette, ColoursDifferAndCarryTransparency) {
  EXPECT_NE(PaletteColor(0), PaletteColor(1));
  EXPECT_EQ(PaletteColor(0), PaletteColor(8));
  EXPECT_EQ(PaletteColor(0, 0x90), "#90" + PaletteColor(0).substr(1));
}

}  // namespace
}  // namespace dexremoe
