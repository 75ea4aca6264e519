// The sheet of best and worst objects.
#include "render/ranking_sheet.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "base/error.h"
#include "geometry/object_files.h"
#include "small_episode.h"

namespace dexremoe {
namespace {

namespace fs = std::filesystem;

class RankingSheetTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_);
    ObjectMesh object;
    object.mesh = BallOf(0.02, 16);
    object.mass = object.volume = 1;
    object.name = "ball";
    object.category = "head";
    WriteObjectMesh(folder_ + "/mesh.h5", object, {"test", "", 1, {}});
    for (const char* name : {"ball", "other"}) {
      ObjectEntry& entry = entries_.emplace_back();
      entry.name = name;
      entry.category = "head";
      entry.folder = folder_;
    }
    ranking_.policy = "base.h5";
    ranking_.worst = {{"ball", "head", "train", 4, {0, 0, 0}, {1, 0, 0}}};
    ranking_.best = {{"other", "head", "train", 4, {2, 1, 3}, {0, 1, 0}}};
    trace_.episodes[0].end = "fall";
  }
  void TearDown() override { fs::remove_all(folder_); }
  Image Draw() {
    RenderOptions options;
    options.supersample = 1;
    options.shadow_size = 256;
    Renderer renderer(options);
    return RankingSheet(renderer, fonts_, {ranking_, entries_, hand_, trace_, "trace.h5"}, 200);
  }
  // Pixels of the object's orange among those of a band: 0 worst, 1 best.
  static int Orange(const Image& image, int band) {
    int count = 0;
    for (int y = band * image.height / 2; y < (band + 1) * image.height / 2; ++y)
      for (int x = 0; x < image.width; ++x) {
        const auto* p = image.at(x, y);
        count += p[0] > p[1] + 60 && p[1] > p[2] + 60;
      }
    return count;
  }
  std::string folder_ = testing::TempDir() + "/dexremoe_ranking_sheet";
  std::vector<ObjectEntry> entries_;
  Ranking ranking_;
  HandModel hand_ = SmallHand();
  TraceFile trace_ = SmallTrace(40);
  Fonts fonts_;
};

TEST_F(RankingSheetTest, EpisodesAreShownBelowTheObjectsThatHaveOne) {
  const Image image = Draw();
  EXPECT_EQ(image.width, 200);
  EXPECT_GT(Orange(image, 0), 20);
  EXPECT_EQ(Orange(image, 1), 0);  // no episode of "other" was recorded
}

TEST_F(RankingSheetTest, AnObjectThatIsNotListedIsAnError) {
  ranking_.best[0].name = "nowhere";
  try {
    Draw();
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("nowhere"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace dexremoe
