#include "geometry/remesh.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/random.h"
#include "geometry/distance_field.h"
#include "shapes.h"

namespace dexremoe {
namespace {

TEST(TriangleBvh, ClosestPointEqualsBruteForce) {
  const TriMesh mesh = SphereMesh(1, 12);
  const TriangleBvh bvh(mesh);
  Rng rng(1, Stream::kTest);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d p(2 * rng.Normal(), rng.Normal(), rng.Normal());
    double least = INFINITY;
    for (const auto& [a, b, c] : mesh.triangles)
      least = std::min(
          least,
          (ClosestPointOnTriangle(p, mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]) - p)
              .norm());
    EXPECT_DOUBLE_EQ(bvh.Closest(p).distance, least);
    EXPECT_DOUBLE_EQ(bvh.Closest(p, static_cast<int>(rng.Index(mesh.triangles.size()))).distance,
                     least);
  }
}

TEST(WindingNumber, IsOneInsideZeroOutside) {
  const TriangleBvh bvh(SphereMesh(1, 16));
  Rng rng(2, Stream::kTest);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d p(rng.Normal(), rng.Normal(), rng.Normal());
    if (std::abs(p.norm() - 1) < 0.02) continue;
    EXPECT_NEAR(bvh.WindingNumber(p), p.norm() < 1 ? 1 : 0, 0.03);
  }
}

// Near the surface nothing is far: the number is that of all triangles, each by its arctangent.
TEST(WindingNumber, CountsEverySheetOfShellsInShells) {
  TriMesh shells;
  for (int i = 1; i <= 5; ++i) {
    const Eigen::Vector3d size = Eigen::Vector3d::Constant(0.2 * i);
    const int first = static_cast<int>(shells.vertices.size());
    const TriMesh box = BoxMesh(-size, size);
    for (const Eigen::Vector3d& v : box.vertices) shells.vertices.push_back(v);
    for (const auto& [a, b, c] : box.triangles)
      shells.triangles.push_back({first + a, first + b, first + c});
  }
  const TriangleBvh bvh(shells);
  for (int i = 0; i <= 5; ++i) {
    const double x = 0.2 * i + 0.1;
    EXPECT_NEAR(bvh.WindingNumber({x, 0.01, 0.02}), 5 - i, 0.03);
    EXPECT_NEAR(bvh.WindingNumber({-0.01, -x, 0.03}), 5 - i, 0.03);
  }
}

TEST(WindingNumber, SeesThroughTheHoleOfAnOpenSphere) {
  TriMesh open = SphereMesh(1, 24);
  std::erase_if(open.triangles, [&](const auto& t) { return open.vertices[t[0]].z() > 0.93; });
  EXPECT_GT(TopologyOf(open).open_edges, 0);
  const TriangleBvh bvh(open);
  EXPECT_GT(bvh.WindingNumber({0, 0, 0}), 0.9);
  EXPECT_GT(bvh.WindingNumber({0, 0, -0.9}), 0.9);
  EXPECT_LT(bvh.WindingNumber({0, 0, 1.3}), 0.5);
  EXPECT_LT(bvh.WindingNumber({0, 0, -1.2}), 0.1);
}

TEST(DistanceField, OfASphereIsItsDistance) {
  const TriMesh sphere = SphereMesh(1, 48);
  DistanceGrid grid = GridAround(BoundsOf(sphere), 24, 3);
  FillSignedDistance(TriangleBvh(sphere), grid);
  for (int z = 0; z < grid.dims[2]; ++z)
    for (int y = 0; y < grid.dims[1]; ++y)
      for (int x = 0; x < grid.dims[0]; ++x)
        EXPECT_NEAR(grid.values[grid.Index(x, y, z)], grid.Position(x, y, z).norm() - 1, 0.004);
  EXPECT_NEAR(grid.Sample({0.5, 0.2, -0.4}), std::sqrt(0.45) - 1, 0.01);
}

TEST(ExtractLevelSet, OfNoiseIsAlwaysAClosedManifold) {
  // Random signs hold every ambiguous case of every cube.
  Rng rng(3, Stream::kTest);
  for (int round = 0; round < 40; ++round) {
    DistanceGrid grid = GridAround({{0, 0, 0}, {1, 1, 1}}, 9, 0);
    const double bias = rng.Uniform(-0.6, 0.6);
    for (double& v : grid.values) v = rng.Uniform(-1, 1) + bias;
    const TriMesh mesh = ExtractLevelSet(grid, 0);
    const Topology topology = TopologyOf(mesh);
    EXPECT_TRUE(topology.ClosedManifold())
        << topology.open_edges << " open, " << topology.crowded_edges << " crowded, "
        << topology.flipped_edges << " flipped, " << topology.pinched_vertices << " pinched";
    EXPECT_GT(MassPropertiesOf(mesh).volume, 0);
  }
}

TEST(ExtractLevelSet, KeepsTheVolume) {
  const TriMesh elbow = ElbowMesh();
  DistanceGrid grid = GridAround(BoundsOf(elbow), 64, 3);
  FillSignedDistance(TriangleBvh(elbow), grid);
  const TriMesh mesh = ExtractLevelSet(grid, 0);
  EXPECT_TRUE(TopologyOf(mesh).ClosedManifold());
  EXPECT_NEAR(MassPropertiesOf(mesh).volume / MassPropertiesOf(elbow).volume, 1, 0.01);
}

TEST(MakeClosedShell, LeavesAClosedMeshAlone) {
  const RepairResult result = MakeClosedShell(ElbowMesh(), {}, "elbow");
  EXPECT_EQ(result.text, "closed as it was");
  EXPECT_EQ(result.mesh.triangles.size(), ElbowMesh().triangles.size());
}

TEST(MakeClosedShell, TurnsAnInsideOutMesh) {
  TriMesh box = BoxMesh({0, 0, 0}, {1, 1, 1});
  for (auto& t : box.triangles) std::swap(t[0], t[1]);
  const RepairResult result = MakeClosedShell(box, {}, "box");
  EXPECT_NEAR(MassPropertiesOf(result.mesh).volume, 1, 1e-12);
}

TEST(MakeClosedShell, JoinsOverlappingOpenShells) {
  TriMesh soup = Joined(BoxMesh({0, 0, 0}, {2, 1, 1}), BoxMesh({1.5, 0.2, 0.2}, {3, 0.8, 0.8}));
  soup.triangles.erase(soup.triangles.begin() + 2);  // a hole
  const RepairResult result =
      MakeClosedShell(soup, {.resolution = 64, .max_triangles = 100000}, "soup");
  EXPECT_TRUE(TopologyOf(result.mesh).ClosedManifold());
  EXPECT_EQ(TopologyOf(result.mesh).shells, 1);
  EXPECT_NE(result.text.find("remeshed: 2 shells, 3 open edges"), std::string::npos) << result.text;
  EXPECT_NEAR(MassPropertiesOf(result.mesh).volume, 2 + 0.36, 0.12);
}

TEST(MakeClosedShell, ThickensASheetThatWouldVanish) {
  // A box with a fin of no thickness.
  TriMesh mesh = BoxMesh({0, 0, 0}, {1, 1, 1});
  mesh.vertices.insert(mesh.vertices.end(), {{0.9, 0.5, 0.1}, {2, 0.5, 0.1}, {2, 0.5, 0.9}});
  mesh.triangles.push_back({8, 9, 10});
  const RepairResult result =
      MakeClosedShell(mesh, {.resolution = 64, .max_triangles = 100000}, "fin");
  EXPECT_NE(result.text.find("thickened"), std::string::npos) << result.text;
  EXPECT_GT(BoundsOf(result.mesh).max.x(), 1.9);
  EXPECT_TRUE(TopologyOf(result.mesh).ClosedManifold());
}

TEST(MakeClosedShell, KeepsTheTriangleLimit) {
  TriMesh open = SphereMesh(1, 24);
  open.triangles.pop_back();
  const RepairResult result = MakeClosedShell(open, {.max_triangles = 6000}, "sphere");
  EXPECT_LE(result.mesh.triangles.size(), 6000u);
  EXPECT_NEAR(MassPropertiesOf(result.mesh).volume, 4.18, 0.1);
}

TEST(MakeClosedShell, RefusesWhatHasNoExtent) {
  TriMesh point;
  point.vertices = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
  point.triangles = {{0, 1, 2}};
  EXPECT_THROW(MakeClosedShell(point, {}, "point"), Error);
}

}  // namespace
}  // namespace dexremoe
