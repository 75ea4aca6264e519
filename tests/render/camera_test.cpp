#include "render/camera.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "base/random.h"

namespace dexremoe {
namespace {

Camera Slanted() {
  Camera camera;
  camera.eye = {0.3, -0.8, 0.4};
  camera.target = {0.05, 0.1, 0.02};
  camera.up = {0, 0, -1};
  camera.fov_y = 0.6;
  return camera;
}

TEST(Camera, TheTargetIsTheMiddleOfTheImage) {
  const Camera camera = Slanted();
  const Eigen::Vector3d at = camera.Project(camera.target, 640, 480);
  EXPECT_NEAR(at.x(), 320, 1e-9);
  EXPECT_NEAR(at.y(), 240, 1e-9);
  EXPECT_NEAR(at.z(), (camera.eye - camera.target).norm(), 1e-12);
}

TEST(Camera, AxesAreARotationAndUpPointsUpInTheImage) {
  const Camera camera = Slanted();
  const Eigen::Matrix3d axes = camera.Axes();
  EXPECT_LT((axes.transpose() * axes - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_NEAR(axes.determinant(), 1, 1e-12);
  const Eigen::Vector3d above = camera.Project(camera.target + 0.05 * camera.up, 640, 480);
  EXPECT_LT(above.y(), 240);
  EXPECT_NEAR(above.x(), 320, 1e-9);
}

TEST(Camera, ProjectAgreesWithTheMatricesOfThePipeline) {
  const Camera camera = Slanted();
  const Eigen::Matrix4d clip_from_world = camera.Projection(640.0 / 480, 0.1, 5) * camera.View();
  Rng rng(3, Stream::kTest);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d p(rng.Uniform(-0.2, 0.2), rng.Uniform(-0.2, 0.2), rng.Uniform(-0.2, 0.2));
    const Eigen::Vector4d clip = clip_from_world * p.homogeneous();
    const Eigen::Vector3d at = camera.Project(p, 640, 480);
    EXPECT_NEAR(at.x(), 320 * (1 + clip.x() / clip.w()), 1e-9);
    EXPECT_NEAR(at.y(), 240 * (1 - clip.y() / clip.w()), 1e-9);
    EXPECT_LT(std::abs(clip.z() / clip.w()), 1);
  }
}

TEST(Camera, NearAndFarPlanesMapToTheEndsOfTheDepthRange) {
  const Eigen::Matrix4d projection = Slanted().Projection(1, 0.25, 4);
  const auto depth = [&](double z) {
    const Eigen::Vector4d clip = projection * Eigen::Vector4d(0, 0, -z, 1);
    return clip.z() / clip.w();
  };
  EXPECT_NEAR(depth(0.25), -1, 1e-12);
  EXPECT_NEAR(depth(4), 1, 1e-12);
}

TEST(Camera, AFramedSphereTouchesTheGivenShareOfTheSmallerSide) {
  const Sphere sphere{{0.1, 0.2, 0.3}, 0.07};
  for (const double aspect : {0.5, 1.0, 2.0}) {
    const Camera camera =
        FrameSphere(sphere, {1, -1, 0.5}, Eigen::Vector3d::UnitZ(), 0.5, aspect, 0.8);
    // The silhouette: half angle asin(r / d), seen through tan.
    const double half = std::tan(std::asin(sphere.radius / (camera.eye - sphere.center).norm()));
    EXPECT_NEAR(half / std::tan(0.25), 0.8 * std::min(1.0, aspect), 1e-9);
  }
}

}  // namespace
}  // namespace dexremoe
