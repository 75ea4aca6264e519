#include "render/gpu_mesh.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "test_meshes.h"

namespace dexremoe {
namespace {

Eigen::Vector3d Normal(const std::vector<float>& corners, std::size_t corner) {
  return Eigen::Vector3f(corners.data() + 6 * corner + 3).cast<double>();
}
Eigen::Vector3d Position(const std::vector<float>& corners, std::size_t corner) {
  return Eigen::Vector3f(corners.data() + 6 * corner).cast<double>();
}

TEST(ShadedCorners, ACubeKeepsFlatFacesBelowItsEdgeAngle) {
  const std::vector<float> corners = ShadedCorners(CubeOf(0.5), 1.0);
  ASSERT_EQ(corners.size(), 6u * 36);
  for (std::size_t c = 0; c < 36; ++c) {
    EXPECT_NEAR(Normal(corners, c).cwiseAbs().maxCoeff(), 1, 1e-6);
    EXPECT_GT(Normal(corners, c).dot(Position(corners, c)), 0);  // outwards
  }
}

TEST(ShadedCorners, ACubeIsRoundedAboveItsEdgeAngle) {
  const std::vector<float> corners = ShadedCorners(CubeOf(0.5), 1.7);
  for (std::size_t c = 0; c < 36; ++c) EXPECT_GT(Normal(corners, c).cwiseAbs().minCoeff(), 0.2);
}

TEST(ShadedCorners, ASphereIsSmooth) {
  const std::vector<float> corners = ShadedCorners(BallOf(0.1, 48), 0.6);
  for (std::size_t c = 0; c < corners.size() / 6; ++c)
    EXPECT_GT(Normal(corners, c).dot(Position(corners, c).normalized()), 0.999);
}

TEST(ShadedCorners, RepeatedVerticesShadeLikeSharedOnes) {
  const TriMesh shared = BallOf(0.1, 16);
  TriMesh soup;
  for (const auto& t : shared.triangles) {
    const int first = int(soup.vertices.size());
    for (int corner : t) soup.vertices.push_back(shared.vertices[corner]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_EQ(ShadedCorners(soup, 0.6), ShadedCorners(shared, 0.6));
}

TEST(ShadedCorners, TrianglesWithoutAreaAreLeftOut) {
  TriMesh mesh = CubeOf(0.5);
  mesh.triangles.push_back({0, 0, 1});
  EXPECT_EQ(ShadedCorners(mesh, 1.0), ShadedCorners(CubeOf(0.5), 1.0));
}

}  // namespace
}  // namespace dexremoe
