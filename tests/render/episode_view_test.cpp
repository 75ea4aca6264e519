#include "render/episode_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>

#include "base/error.h"
#include "render/object_sheet.h"
#include "small_episode.h"

namespace dexremoe {
namespace {

class EpisodeViewTest : public testing::Test {
 protected:
  EpisodeViewTest() : renderer_(Options()) {}
  static RenderOptions Options() {
    RenderOptions options;
    options.supersample = 1;
    options.shadow_size = 256;
    return options;
  }
  EpisodeView View() { return EpisodeView(renderer_, fonts_, hand_, ball_, trace_, 0, "trace.h5"); }
  Renderer renderer_;
  Fonts fonts_;
  HandModel hand_ = SmallHand();
  TriMesh ball_ = BallOf(0.02, 32);
  TraceFile trace_ = SmallTrace(60);
};

TEST_F(EpisodeViewTest, TheObjectIsOrangeAndTheGoalGreenBesideIt) {
  const Image image = View().Picture(10, 320, 240, GoalPlace::kBeside);
  const Camera camera = HandCamera(GoalPlace::kBeside, 4.0 / 3);
  const Eigen::Vector3d p(0, 0.06, 0.12);
  const Eigen::Vector3d object = camera.Project(p, 320, 240);
  const Eigen::Vector3d goal = camera.Project(p + GoalOffset(GoalPlace::kBeside, camera), 320, 240);
  const auto* orange = image.at(int(object.x()), int(object.y()));
  EXPECT_GT(orange[0], orange[1] + 30);
  EXPECT_GT(orange[1], orange[2] + 30);
  const auto* green = image.at(int(goal.x()), int(goal.y()));
  EXPECT_GT(green[1], green[0] + 20);
  EXPECT_GT(goal.x(), object.x() + 60);
}

TEST_F(EpisodeViewTest, GravityPointsDownInTheImage) {
  for (const GoalPlace place : {GoalPlace::kBeside, GoalPlace::kBelow, GoalPlace::kOver}) {
    const Camera camera = HandCamera(place, 1.0);
    const Eigen::Vector3d palm = camera.Project({0, 0.06, 0.0}, 200, 200);
    const Eigen::Vector3d below = camera.Project({0, 0.06, 0.12}, 200, 200);
    EXPECT_GT(below.y(), palm.y() + 40);
    // The palm, the object and its ghost are within the image.
    const Eigen::Vector3d ghost =
        camera.Project(Eigen::Vector3d(0, 0.06, 0.12) + GoalOffset(place, camera), 200, 200);
    for (const Eigen::Vector3d& at : {palm, below, ghost}) {
      EXPECT_GT(at.head<2>().minCoeff(), 0);
      EXPECT_LT(at.head<2>().maxCoeff(), 200);
    }
  }
}

TEST_F(EpisodeViewTest, AStripHoldsItsFramesSideBySide) {
  EpisodeView view = View();
  const std::vector<int> steps = SpreadSteps(0, 59, 4);
  EXPECT_EQ(steps, (std::vector<int>{0, 20, 39, 59}));
  const Image strip = view.Strip(steps, 600);
  EXPECT_LE(strip.width, 600);
  EXPECT_GT(strip.width, 590);
  EXPECT_GT(strip.height, strip.width / 4);
  EXPECT_EQ(view.Strip(steps, 600).rgb, strip.rgb);
}

TEST_F(EpisodeViewTest, AnotherHandsTraceIsRefusedByJointName) {
  trace_.joint_names = {"twist"};
  try {
    View();
    FAIL() << "the trace of another hand was taken";
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("trace.h5"), std::string::npos);
    EXPECT_NE(message.find("expected bend"), std::string::npos);
    EXPECT_NE(message.find("found twist"), std::string::npos);
  }
  trace_.joint_names = {"bend", "more"};
  EXPECT_THROW(View(), Error);
}

TEST_F(EpisodeViewTest, StepsOutsideTheEpisodeAreRefused) {
  EpisodeView view = View();
  EXPECT_THROW(view.Picture(60, 64, 48, GoalPlace::kOver), Error);
  EXPECT_THROW(view.Strip({0, -1}, 200), Error);
}

TEST_F(EpisodeViewTest, WithoutAGateNoWeightsAreShown) {
  const int with_gate = View().Strip({0, 10}, 400).height;
  trace_.expert_names.clear();
  trace_.episodes[0].gate.clear();
  EpisodeView view = View();
  EXPECT_EQ(view.Picture(0, 320, 240, GoalPlace::kBeside).width, 320);
  EXPECT_LT(view.Strip({0, 10}, 400).height, with_gate);
}

TEST_F(EpisodeViewTest, TheMostSuccessfulEpisodeIsPickedUnlessOneIsNamed) {
  trace_.episodes.push_back(trace_.episodes[0]);
  trace_.episodes[1].successes = 5;
  EXPECT_EQ(PickEpisode(trace_, -1, "t"), 1);
  EXPECT_EQ(PickEpisode(trace_, 0, "t"), 0);
  EXPECT_THROW(PickEpisode(trace_, 2, "t"), Error);
  EXPECT_THROW(PickEpisode(TraceFile(), -1, "t"), Error);
}

TEST_F(EpisodeViewTest, AFilmHasItsFrames) {
  const std::string path = testing::TempDir() + "/dexremoe_film_test.mp4";
  int frames = 0;
  View().Film(path, 0, 59, 160, 120, 30, GoalPlace::kOver, [&](int, int total) { frames = total; });
  EXPECT_EQ(frames, 30);  // every other one of 60 steps at 60 Hz
  EXPECT_GT(std::filesystem::file_size(path), 1000u);
  std::filesystem::remove(path);
}

TEST_F(EpisodeViewTest, TheHandPictureNeedsOneAnglePerJoint) {
  EXPECT_THROW(HandPicture(renderer_, hand_, {0, 0}, false, 64, 48), Error);
  const Image image = HandPicture(renderer_, hand_, {0.3}, false, 64, 48);
  EXPECT_EQ(image.height, 48);
}

TEST_F(EpisodeViewTest, TheHandStandsBesideItsParts) {
  Collider palm;
  palm.shape = ColliderShape::kBox;
  palm.half_size = Eigen::Vector3d::Constant(0.03);
  hand_.colliders = {palm};
  EXPECT_THROW(HandPartsPicture(renderer_, hand_, {0, 0}, 128, 48), Error);
  const Image both = HandPartsPicture(renderer_, hand_, {0.3}, 128, 48);
  const Image left = HandPicture(renderer_, hand_, {0.3}, false, 64, 48);
  ASSERT_EQ(both.width, 128);
  int same = 0, coloured = 0;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      same += std::equal(left.at(x, y), left.at(x, y) + 3, both.at(x, y));
      const auto [low, high] = std::minmax_element(both.at(64 + x, y), both.at(64 + x, y) + 3);
      coloured += *high - *low > 60;
    }
  EXPECT_EQ(same, 64 * 48);
  EXPECT_GT(coloured, 30);
}

TEST_F(EpisodeViewTest, SlowTheRealHandIsDrawn) {
  const char* urdf = std::getenv("DEX_REAL_HAND");
  if (urdf == nullptr) GTEST_SKIP() << "DEX_REAL_HAND is not set";
  HandOptions options;
  options.urdf = urdf;
  const HandModel hand = LoadHand(options);
  const std::vector<double> q(hand.num_joints(), 0.2);
  const Image image = HandPicture(renderer_, hand, q, true, 160, 120);
  int dark = 0;
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x) dark += Lightness(image, x, y) < 200;
  EXPECT_GT(dark, 1500);
}

SheetObject NamedBall(int i) {
  SheetObject object;
  object.name = "ball_" + std::to_string(i);
  object.category = "head";
  object.mesh = BallOf(0.04, 24);
  object.parts = {BallOf(0.02, 12), CubeOf(0.02)};
  object.detail = "2 parts";
  return object;
}

TEST_F(EpisodeViewTest, TheDataSetSheetPutsTrainingObjectsLeftOfTheLineAndTheOthersRight) {
  const auto ink_of = [&](const std::vector<const char*>& splits) {
    std::vector<ObjectEntry> entries;
    for (const char* split : splits) entries.push_back({"ball", "head", split, "", "", ""});
    const Image sheet = DatasetSheet(renderer_, fonts_, entries, NamedBall, 450);
    std::pair<int, int> ink;  // coloured pixels in the left and the right half
    for (int y = 0; y < sheet.height; ++y)
      for (int x = 0; x < sheet.width; ++x) {
        const std::uint8_t* p = sheet.at(x, y);
        if (std::max({p[0], p[1], p[2]}) - std::min({p[0], p[1], p[2]}) > 60)
          ++(x < sheet.width / 2 ? ink.first : ink.second);
      }
    return ink;
  };
  const auto [train_left, train_right] = ink_of({"train"});
  EXPECT_GT(train_left, 100);
  EXPECT_EQ(train_right, 0);
  const auto [ood_left, ood_right] = ink_of({"ood"});
  EXPECT_EQ(ood_left, 0);
  EXPECT_GT(ood_right, 100);
}

TEST_F(EpisodeViewTest, ASheetGivesEveryObjectACellUnderItsCategory) {
  std::vector<ObjectEntry> entries;
  for (const char* category : {"animal", "animal", "head", "head", "head", "shoe"})
    entries.push_back({"ball", category, "train", "", "", ""});
  std::vector<int> drawn;
  const ObjectSource source = [&](int i) {
    drawn.push_back(i);
    return NamedBall(i);
  };
  const Image sheet = ObjectSheet(renderer_, fonts_, entries, source, 3, 300);
  EXPECT_EQ(drawn, (std::vector<int>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(sheet.width, 300);
  // Three rows of blocks (2, 3 and 1 cells of 3): a ball in the middle of each, paper beside them.
  const int row = sheet.height / 3;
  EXPECT_LT(Lightness(sheet, 50, row - 55), 240);
  EXPECT_EQ(Lightness(sheet, 250, row - 55), 255);  // the third cell of the first row is empty
}

TEST_F(EpisodeViewTest, ACategoryHasItsColourWhicheverOthersAreOnTheSheet) {
  const auto ball_color = [&](const std::vector<std::string>& categories) {
    std::vector<ObjectEntry> entries;
    for (const std::string& category : categories)
      entries.push_back({"ball", category, "train", "", "", ""});
    const Image sheet = ObjectSheet(renderer_, fonts_, entries, NamedBall, 1, 100);
    const auto* pixel = sheet.at(50, sheet.height - 62);  // in the last block's only picture
    return std::array<int, 3>{pixel[0], pixel[1], pixel[2]};
  };
  EXPECT_EQ(ball_color({"train"}), ball_color({"animal", "train"}));
  EXPECT_NE(ball_color({"train"}), ball_color({"animal"}));
}

TEST_F(EpisodeViewTest, PartsAreShownBesideTheMesh) {
  const Image sheet = PartsSheet(renderer_, fonts_, 2, NamedBall, 0.3, 1, 200);
  EXPECT_EQ(sheet.width, 200);
  const auto* mesh = sheet.at(50, 40);
  EXPECT_GT(mesh[0], mesh[2] + 40);  // orange
  EXPECT_NE(Lightness(sheet, 150, 40), 255);
}

TEST(UpAxis, WordsAreReadAndOthersRefused) {
  EXPECT_EQ(UpAxis("y", "m.ply"), Eigen::Vector3d::UnitY());
  EXPECT_EQ(UpAxis("-z", "m.ply"), -Eigen::Vector3d::UnitZ());
  EXPECT_EQ(UpAxis("auto", "/no/such/m.ply"), Eigen::Vector3d::UnitZ());
  EXPECT_THROW(UpAxis("w", "m.ply"), Error);
  EXPECT_THROW(UpAxis("", "m.ply"), Error);
}

}  // namespace
}  // namespace dexremoe
