// Sampling of surfaces, normals, and the cloud's files.
#include "shape/cloud.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/point_types.h>

#include <cstdlib>
#include <filesystem>

#include "base/error.h"
#include "geometry/mesh_io.h"
#include "io/atomic_file.h"
#include "shape/farthest.h"
#include "shapes.h"

namespace dexremoe {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::string TemporaryPath(const std::string& name) { return ::testing::TempDir() + name; }

// The side of a box that a point lies on, by the normal it was given.
int SideOf(const Eigen::Vector3d& normal) {
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return 2 * axis + (normal[axis] > 0);
}

TEST(SampleSurface, PointsPerSideOfABoxFollowTheAreas) {
  const Eigen::Vector3d size(0.02, 0.05, 0.08);
  const int count = 20000;
  Rng rng(1, Stream::kCloud);
  const PointCloud cloud = SampleSurface(BoxMesh(size), count, rng);
  ASSERT_EQ(cloud.points.size(), static_cast<std::size_t>(count));
  std::vector<int> seen(6, 0);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const int side = SideOf(cloud.normals[i]);
    ++seen[side];
    const double plane = (side % 2 == 0 ? -0.5 : 0.5) * size[side / 2];
    ASSERT_NEAR(cloud.points[i][side / 2], plane, 1e-15);
    for (int k = 0; k < 3; ++k) ASSERT_LE(std::abs(cloud.points[i][k]), size[k] / 2 + 1e-15);
  }
  const Eigen::Vector3d area(size.y() * size.z(), size.x() * size.z(), size.x() * size.y());
  double chi2 = 0;
  for (int side = 0; side < 6; ++side) {
    const double expected = count * area[side / 2] / (2 * area.sum());
    chi2 += std::pow(seen[side] - expected, 2) / expected;
  }
  EXPECT_LT(chi2, 20.5);  // 0.1 % of the chi-square distribution of 5 degrees of freedom
}

TEST(SampleSurface, PointsAreUniformWithinATriangle) {
  TriMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  Rng rng(2, Stream::kCloud);
  const int count = 16000;
  // Four congruent parts of the triangle: the corners and the middle.
  std::vector<int> seen(4, 0);
  for (const Eigen::Vector3d& p : SampleSurface(mesh, count, rng).points) {
    ASSERT_GE(p.minCoeff(), 0);
    ASSERT_LE(p.x() + p.y(), 1 + 1e-15);
    ++seen[p.x() > 0.5 ? 0 : p.y() > 0.5 ? 1 : p.x() + p.y() < 0.5 ? 2 : 3];
  }
  double chi2 = 0;
  for (const int n : seen) chi2 += std::pow(n - count / 4.0, 2) / (count / 4.0);
  EXPECT_LT(chi2, 16.3);  // 0.1 %, 3 degrees of freedom
}

TEST(SampleSurface, RefusesAMeshWithoutArea) {
  TriMesh mesh = BoxMesh({0, 0, 0});
  Rng rng(3, Stream::kCloud);
  EXPECT_THAT([&] { SampleSurface(mesh, 10, rng); },
              ThrowsMessage<Error>(HasSubstr("positive area")));
}

TEST(SampleCloud, OfASphereIsSpreadEvenlyWithNormalsAlongTheRadius) {
  const double radius = 0.04;
  const PointCloud cloud = SampleCloud(SphereMesh(radius, 48), CloudOptions(), 5);
  ASSERT_EQ(cloud.points.size(), 1024u);
  double nearest = INFINITY;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    EXPECT_NEAR(cloud.points[i].norm(), radius, 0.002 * radius);
    EXPECT_GT(cloud.normals[i].dot(cloud.points[i].normalized()), 0.97);
    EXPECT_NEAR(cloud.normals[i].norm(), 1, 1e-6);
    for (std::size_t j = 0; j < i; ++j)
      nearest = std::min(nearest, (cloud.points[i] - cloud.points[j]).norm());
  }
  // Random points come as near as radius / 500; farthest points keep about the distance of a
  // hexagonal packing, sqrt(8 pi / (sqrt 3 * 1024)) radii = 0.119.
  EXPECT_GT(nearest, 0.6 * 0.119 * radius);
}

TEST(SampleCloud, NormalsOfThinPlatesPointOutward) {
  const PointCloud cloud = SampleCloud(BoxMesh({0.08, 0.05, 0.001}), CloudOptions(), 5);
  int flat = 0, right = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const Eigen::Vector3d& p = cloud.points[i];
    if (std::abs(p.x()) > 0.038 || std::abs(p.y()) > 0.023) continue;
    ++flat;
    right += cloud.normals[i].z() * p.z() > 0;
  }
  EXPECT_GT(flat, 500);
  EXPECT_GT(right, 0.98 * flat);
}

TEST(SampleCloud, DependsOnTheSeedAlone) {
  const TriMesh mesh = BoxMesh({0.03, 0.04, 0.05});
  const PointCloud a = SampleCloud(mesh, CloudOptions(), 1),
                   b = SampleCloud(mesh, CloudOptions(), 1);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_NE(a.points, SampleCloud(mesh, CloudOptions(), 2).points);
}

PointCloud SmallCloud() {
  CloudOptions options;
  options.points = 64;
  return SampleCloud(BoxMesh({0.03, 0.04, 0.05}), options, 1);
}

TEST(CloudFile, ReadsWhatWasWritten) {
  const PointCloud cloud = SmallCloud();
  const std::string path = TemporaryPath("cloud.h5");
  WriteCloud(path, cloud, {"test", "", 1, {}});
  const PointCloud read = ReadCloud(path);
  EXPECT_EQ(read.points, cloud.points);
  EXPECT_EQ(read.normals, cloud.normals);
  const std::string first = ReadFile(path);
  WriteCloud(path, cloud, {"test", "", 1, {}});
  EXPECT_EQ(ReadFile(path), first);
}

TEST(CloudFile, RefusesOtherFormatsVersionsAndContents) {
  const std::string path = TemporaryPath("bad_cloud.h5");
  const auto write = [&](H5Format format, std::vector<double> points) {
    const auto n = static_cast<std::int64_t>(points.size() / 3);
    H5Writer file(path, format, {"test", "", 1, {}});
    file.Write("points", points, {n, 3}, {"m", "", ""});
    file.Write("normals", points, {n, 3}, {"1", "", ""});
    file.Commit();
  };
  const std::vector<double> good(12, 0.5);
  const auto expect_error = [&](const char* text) {
    EXPECT_THAT([&] { ReadCloud(path); },
                ThrowsMessage<Error>(::testing::AllOf(HasSubstr(path), HasSubstr(text))));
  };
  write({"dexremoe.mesh", 1}, good);
  expect_error("dexremoe.cloud");
  write({"dexremoe.cloud", 99}, good);
  expect_error("99");
  write(kCloudFormat, {1, 2, 3});
  expect_error("at least 4 points, found 1");
  std::vector<double> nan = good;
  nan[7] = NAN;
  write(kCloudFormat, nan);
  expect_error("found nan in row 2");
  EXPECT_THROW(ReadCloud(TemporaryPath("absent.h5")), Error);
}

template <typename Read>
void ExpectSamePoints(const PointCloud& cloud, const std::string& path, const Read& read) {
  ExportCloud(path, cloud);
  pcl::PointCloud<pcl::PointNormal> back;
  ASSERT_EQ(read(path, back), 0);
  ASSERT_EQ(back.size(), cloud.points.size());
  for (std::size_t i = 0; i < back.size(); ++i) {
    EXPECT_EQ(back[i].getVector3fMap(), cloud.points[i].cast<float>());
    EXPECT_EQ(back[i].getNormalVector3fMap(), cloud.normals[i].cast<float>());
  }
  EXPECT_FALSE(std::filesystem::exists(path + ".tmp"));
}

TEST(ExportCloud, PcdAndPlyHoldThePointsAndNormals) {
  const PointCloud cloud = SmallCloud();
  ExpectSamePoints(cloud, TemporaryPath("cloud.pcd"), [](const std::string& path, auto& back) {
    return pcl::io::loadPCDFile(path, back);
  });
  ExpectSamePoints(cloud, TemporaryPath("cloud.ply"), [](const std::string& path, auto& back) {
    return pcl::io::loadPLYFile(path, back);
  });
}

TEST(ExportCloud, RefusesOtherEndings) {
  EXPECT_THAT([] { ExportCloud(TemporaryPath("cloud.xyz"), SmallCloud()); },
              ThrowsMessage<Error>(HasSubstr("expected the ending .pcd or .ply, found '.xyz'")));
}

TEST(SampleCloud, OfARealMeshLiesOnItsSurfaceBox) {
  const char* folder = std::getenv("DEX_REAL_MESHES");
  if (folder == nullptr) GTEST_SKIP() << "DEX_REAL_MESHES is not set";
  int meshes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".ply" || ++meshes > 3) continue;
    const TriMesh mesh = LoadMesh(entry.path());
    const Box3 box = BoundsOf(mesh);
    Box3 sampled;
    for (const Eigen::Vector3d& p : SampleCloud(mesh, CloudOptions(), 1).points) sampled.Extend(p);
    EXPECT_TRUE(((sampled.min - box.min).array() >= -1e-9).all()) << entry.path();
    EXPECT_TRUE(((box.max - sampled.max).array() >= -1e-9).all()) << entry.path();
    EXPECT_GT(sampled.Size().norm(), 0.85 * box.Size().norm()) << entry.path();
  }
  EXPECT_GE(meshes, 1);
}

}  // namespace
}  // namespace dexremoe
