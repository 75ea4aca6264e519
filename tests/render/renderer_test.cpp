#include "render/renderer.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "base/error.h"
#include "test_meshes.h"

namespace dexremoe {
namespace {

constexpr int kWidth = 160, kHeight = 120;

const Material kRed{{0.8f, 0.1f, 0.1f}, 0.2f, 1};
const Material kGreen{{0.1f, 0.7f, 0.1f}, 0.2f, 1};

class RendererTest : public testing::Test {
 protected:
  RendererTest() : renderer_(Options()) {
    camera_.eye = {0, -0.5, 0};
    camera_.fov_y = 0.5;
    ball_ = renderer_.AddMesh(BallOf(0.03, 48));
  }
  static RenderOptions Options() {
    RenderOptions options;
    options.supersample = 2;
    options.shadow_size = 512;
    return options;
  }
  Item BallAt(const Eigen::Vector3d& p, const Material& material, double scale = 1) const {
    Item item;
    item.mesh = ball_;
    item.X_WM.p = p;
    item.scale = scale;
    item.material = material;
    return item;
  }
  Image Draw(std::vector<Item> items) {
    Scene scene;
    scene.items = std::move(items);
    return renderer_.Draw(scene, camera_, kWidth, kHeight);
  }

  Renderer renderer_;
  Camera camera_;
  int ball_ = 0;
};

TEST_F(RendererTest, NeedsNoDisplay) {
  unsetenv("DISPLAY");
  const Renderer renderer(Options());
  EXPECT_FALSE(renderer.context().driver().empty());
}

TEST_F(RendererTest, TheImageHasTheSizeAskedFor) {
  Scene scene;
  scene.items = {BallAt({0, 0, 0}, kRed)};
  for (const auto& [w, h] : {std::pair(33, 57), std::pair(200, 20), std::pair(1, 1)}) {
    const Image image = renderer_.Draw(scene, camera_, w, h);
    EXPECT_EQ(image.width, w);
    EXPECT_EQ(image.height, h);
    EXPECT_EQ(image.rgb.size(), std::size_t(3) * w * h);
  }
}

TEST_F(RendererTest, ABallAppearsWhereThePinholeSaysAndNowhereElse) {
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.06, 0.1, -0.03),
                                   Eigen::Vector3d(-0.05, -0.1, 0.04)}) {
    const Image empty = Draw({});
    const Image image = Draw({BallAt(p, kRed)});
    const Eigen::Vector3d at = camera_.Project(p, kWidth, kHeight);
    const double focal = kHeight / 2.0 / std::tan(camera_.fov_y / 2);
    const double radius = focal * 0.03 / at.z();
    double sum_x = 0, sum_y = 0;
    int inside = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const double distance = std::hypot(x + 0.5 - at.x(), y + 0.5 - at.y());
        if (distance < radius - 1.5) {
          EXPECT_GT(Redness(image, x, y), 20) << x << ' ' << y;
        }
        if (distance > radius * 1.05 + 1.5) {
          EXPECT_TRUE(SamePixel(image, empty, x, y));
        }
        if (Redness(image, x, y) <= 20) continue;
        ++inside;
        sum_x += x + 0.5;
        sum_y += y + 0.5;
      }
    EXPECT_NEAR(sum_x / inside, at.x(), 0.6);
    EXPECT_NEAR(sum_y / inside, at.y(), 0.6);
    EXPECT_NEAR(std::sqrt(inside / M_PI), radius, 0.05 * radius + 0.5);
  }
}

TEST_F(RendererTest, TheNearerBallHidesTheFartherWhateverTheOrder) {
  const Item near = BallAt({0, -0.1, 0}, kRed, 0.5), far = BallAt({0, 0.1, 0}, kGreen);
  const Image one = Draw({near, far}), other = Draw({far, near});
  EXPECT_EQ(one.rgb, other.rgb);
  EXPECT_GT(Redness(one, kWidth / 2, kHeight / 2), 40);
  EXPECT_GT(Greenness(one, kWidth / 2 + 9, kHeight / 2), 40);  // beyond the small near one
}

TEST_F(RendererTest, AGhostMixesWithWhatIsBehindIt) {
  Material ghost = kGreen;
  ghost.opacity = 0.4f;
  const Item back = BallAt({0, 0.1, 0}, kRed);
  const Image solid = Draw({back});
  const Image mixed = Draw({back, BallAt({0, -0.1, 0}, ghost, 0.5)});
  const Image alone = Draw({BallAt({0, -0.1, 0}, kGreen, 0.5)});
  const int x = kWidth / 2, y = kHeight / 2;
  EXPECT_LT(Redness(mixed, x, y), Redness(solid, x, y) - 10);
  EXPECT_GT(Redness(mixed, x, y), Redness(alone, x, y) + 10);
}

TEST_F(RendererTest, AGhostBehindASolidIsHiddenAndCastsNoShadow) {
  Material ghost = kGreen;
  ghost.opacity = 0.4f;
  const Item solid = BallAt({0, 0, 0}, kRed);
  const Image without = Draw({solid});
  const Image behind = Draw({solid, BallAt({0, 0.1, 0}, ghost, 0.5)});
  EXPECT_EQ(behind.rgb, without.rgb);
}

TEST_F(RendererTest, GhostsAreDrawnFarToNearWhateverTheOrder) {
  Material red = kRed, green = kGreen;
  red.opacity = green.opacity = 0.5f;
  const Item near = BallAt({0, -0.1, 0}, red, 0.5), far = BallAt({0, 0.1, 0}, green);
  EXPECT_EQ(Draw({near, far}).rgb, Draw({far, near}).rgb);
}

TEST_F(RendererTest, EqualScenesGiveEqualBytesInOneRendererAndInTwo) {
  const std::vector<Item> items = {BallAt({0, 0, 0}, kRed), BallAt({0.04, 0, 0.02}, kGreen)};
  const Image first = Draw(items), again = Draw(items);
  Renderer other(Options());
  Item a = items[0], b = items[1];
  a.mesh = b.mesh = other.AddMesh(BallOf(0.03, 48));
  Scene scene;
  scene.items = {a, b};
  EXPECT_EQ(first.rgb, again.rgb);
  EXPECT_EQ(other.Draw(scene, camera_, kWidth, kHeight).rgb, first.rgb);
}

TEST_F(RendererTest, ABlockerTowardsTheLightDarkensAndOneAwayFromItDoesNot) {
  Scene scene;
  scene.items = {BallAt({0, 0, 0}, kRed)};
  const Image lit = renderer_.Draw(scene, camera_, kWidth, kHeight);
  const Eigen::Vector3d towards = camera_.Axes() * scene.light.normalized();
  const auto with = [&](double side) {
    scene.items.resize(1);
    scene.items.push_back(BallAt(side * 0.12 * towards, kGreen, 0.9));
    return renderer_.Draw(scene, camera_, kWidth, kHeight);
  };
  // The lit spot: where the ball's surface faces half the light, half the eye.
  const Eigen::Vector3d p = 0.03 * (towards - Eigen::Vector3d::UnitY()).normalized();
  const Eigen::Vector3d at = camera_.Project(p, kWidth, kHeight);
  const int x = int(at.x()), y = int(at.y());
  const Image shaded = with(1), clear = with(-1);
  EXPECT_LT(Lightness(shaded, x, y), 0.8 * Lightness(lit, x, y));
  EXPECT_GT(Lightness(clear, x, y), 0.95 * Lightness(lit, x, y));
}

TEST_F(RendererTest, TheFloorDarkensUnderAnObjectAndFadesIntoTheBackground) {
  camera_.eye = {0, -0.5, 0.3};
  Scene scene;
  scene.top = scene.bottom = Eigen::Vector3f::Ones();
  scene.items = {BallAt({0, 0, 0.03}, kRed)};
  scene.floor = Floor{{0, 0, 0}, Eigen::Vector3d::UnitZ(), 0.1};
  const Image image = renderer_.Draw(scene, camera_, kWidth, kHeight);
  const Eigen::Vector3d under = camera_.Project({0.012, -0.015, 0}, kWidth, kHeight);
  EXPECT_LT(Lightness(image, int(under.x()), int(under.y())), 245);
  EXPECT_GT(Lightness(image, 1, 1), 253);
  EXPECT_GT(Lightness(image, kWidth - 2, kHeight - 2), 253);
}

TEST_F(RendererTest, ScaleAndPoseActAsWritten) {
  Item item = BallAt({0.02, 0.03, -0.01}, kRed, 1.5);
  const Sphere bounds = renderer_.Bounds(item);
  EXPECT_LT((bounds.center - item.X_WM.p).norm(), 1e-9);
  EXPECT_NEAR(bounds.radius, 0.045, 1e-9);
}

TEST_F(RendererTest, AnImageTooLargeForTheDriverIsRefused) {
  Scene scene;
  EXPECT_THROW(renderer_.Draw(scene, camera_, 1 << 20, 16), Error);
}

}  // namespace
}  // namespace dexremoe
