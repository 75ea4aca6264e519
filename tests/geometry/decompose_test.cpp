#include "geometry/decompose.h"

#include <gtest/gtest.h>

#include <numeric>

#include "base/error.h"
#include "base/random.h"
#include "geometry/cluster.h"
#include "geometry/concavity.h"
#include "geometry/triangle_bvh.h"
#include "geometry/voxel_solid.h"
#include "shapes.h"

namespace dexremoe {
namespace {

// Three crossed bars as one closed mesh.
TriMesh CrossMesh() {
  DistanceGrid grid = GridAround({{-3, -3, -3}, {3, 3, 3}}, 48, 2);
  for (std::size_t i = 0; i < grid.values.size(); ++i) {
    const int nx = grid.dims[0], ny = grid.dims[1], n = static_cast<int>(i);
    const Eigen::Vector3d p = grid.Position(n % nx, n / nx % ny, n / (nx * ny)).cwiseAbs();
    double d = INFINITY;
    for (int k = 0; k < 3; ++k)
      d = std::min(d, std::max({p[k] - 3, p[(k + 1) % 3] - 1, p[(k + 2) % 3] - 1}));
    grid.values[i] = d;
  }
  return ExtractLevelSet(grid, 0);
}

void ExpectValid(const ConvexParts& parts, const DecomposeOptions& options) {
  EXPECT_LE(static_cast<int>(parts.size()), options.parts);
  for (const TriMesh& part : parts) {
    EXPECT_LE(static_cast<int>(part.vertices.size()), options.hull_vertices);
    EXPECT_TRUE(TopologyOf(part).ClosedManifold());
    EXPECT_GT(MassPropertiesOf(part).volume, 0);
    EXPECT_TRUE(IsConvex(part, 1e-9 * BoundsOf(part).Size().norm()));
  }
}

// Share of random points inside `mesh` that lie within `tolerance` of some part.
double Covered(const TriMesh& mesh, const ConvexParts& parts, double tolerance) {
  const TriangleBvh bvh(mesh);
  const Box3 box = BoundsOf(mesh);
  Rng rng(1, Stream::kTest);
  int inside = 0, covered = 0;
  while (inside < 1000) {
    const Eigen::Vector3d p = box.min + box.Size().cwiseProduct(Eigen::Vector3d(
                                            rng.Uniform(), rng.Uniform(), rng.Uniform()));
    if (bvh.WindingNumber(p) < 0.5) continue;
    ++inside;
    for (const TriMesh& part : parts)
      if (DistanceOutside(part, p) <= tolerance) {
        ++covered;
        break;
      }
  }
  return covered / 1000.0;
}

TEST(Voxelise, KeepsTheVolumeExactly) {
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(0.6, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  for (const TriMesh& mesh : {ElbowMesh(), Transformed(ElbowMesh(), R, {0.1, 0, 0}),
                              SphereMesh(0.04, 20), BoxMesh({0, 0, 0}, {1, 2, 3})}) {
    const double volume = MassPropertiesOf(mesh).volume;
    EXPECT_NEAR(Voxelise(mesh, 20000).volume, volume, 1e-9 * volume);
    EXPECT_NEAR(Voxelise(mesh, 3000).volume, volume, 1e-9 * volume);
  }
}

TEST(Voxelise, CountsOverlappingShellsOnce) {
  const TriMesh mesh = Joined(BoxMesh({0, 0, 0}, {2, 1, 1}), BoxMesh({1, 0.2, 0.2}, {3, 0.8, 0.8}));
  EXPECT_NEAR(Voxelise(mesh, 40000).volume, 2.36, 0.05);
}

TEST(DecomposeConvex, GivesOnePartForConvexInput) {
  for (const TriMesh& mesh : {BoxMesh({0, 0, 0}, {0.1, 0.05, 0.02}), SphereMesh(0.04, 24)}) {
    DecomposeOptions options;
    options.hull_vertices = 64;
    const ConvexParts parts = DecomposeConvex(mesh, options);
    ASSERT_EQ(parts.size(), 1u);
    ExpectValid(parts, options);
  }
  const TriMesh box = BoxMesh({0, 0, 0}, {0.1, 0.05, 0.02});
  const DecompositionQuality quality = QualityOf(box, DecomposeConvex(box, {}));
  EXPECT_NEAR(quality.volume_ratio, 1, 1e-9);
  EXPECT_LT(quality.hausdorff_ratio, 1e-6);
}

TEST(DecomposeConvex, FindsTheTwoBarsOfAnElbow) {
  const TriMesh mesh = ElbowMesh();
  DecomposeOptions options;
  const ConvexParts parts = DecomposeConvex(mesh, options);
  ExpectValid(parts, options);
  EXPECT_GE(parts.size(), 2u);
  EXPECT_LE(parts.size(), 4u);
  const DecompositionQuality quality = QualityOf(mesh, parts);
  EXPECT_NEAR(quality.volume_ratio, 1, 0.03);
  EXPECT_LT(quality.hausdorff_ratio, 0.02);
  EXPECT_GT(Covered(mesh, parts, 1e-9), 0.999);
}

TEST(DecomposeConvex, FindsTheArmsOfACross) {
  const TriMesh mesh = CrossMesh();
  DecomposeOptions options;
  const ConvexParts parts = DecomposeConvex(mesh, options);
  ExpectValid(parts, options);
  EXPECT_GE(parts.size(), 3u);
  const DecompositionQuality quality = QualityOf(mesh, parts);
  EXPECT_NEAR(quality.volume_ratio, 1, 0.1);
  EXPECT_LT(quality.hausdorff_ratio, 0.03);
  EXPECT_GT(Covered(mesh, parts, 0.01), 0.99);
}

TEST(Concavity, IsTheStickOutOfAHullOrTheDepthOfAHollow) {
  // The L's hull passes between its arms, up to 1 cm from either.
  const TriMesh elbow = ElbowMesh();
  const VoxelSolid solid = Voxelise(elbow, 20000);
  std::vector<int> all(solid.voxels.size());
  std::iota(all.begin(), all.end(), 0);
  const Concavity concavity(solid, 0.01, 1e-6);
  const TriMesh hull = *ConvexHull(elbow.vertices);
  const Concavity::Fit fit = concavity.FitOf(hull, all);
  EXPECT_NEAR(fit.distance, 0.01, 0.7 * solid.spacing);
  EXPECT_NEAR(concavity.CostOf(fit.distance), 1e-6 * std::pow(fit.distance / 0.01, 3), 1e-15);
  const TriMesh bar = BoxMesh({0, 0, 0}, {0.03, 0.01, 0.01});
  std::vector<int> low;
  for (const int i : all)
    if (solid.Corner(solid.voxels[i].cell).z() + solid.spacing < 0.01) low.push_back(i);
  EXPECT_LT(concavity.FitOf(bar, low).distance, 0.7 * solid.spacing);
}

TEST(CutBest, LaysADeepSlitOpen) {
  // A slit of one hundredth of the block's volume, nearer to one end: no plane that saves volume.
  const TriMesh left = BoxMesh({0, 0, 0}, {0.0298, 0.04, 0.04});
  TriMesh block = Joined(left, BoxMesh({0.0302, 0, 0}, {0.1, 0.04, 0.04}));
  block = Joined(block, BoxMesh({0.02, 0, 0}, {0.04, 0.04, 0.008}));
  const VoxelSolid solid = Voxelise(block, 60000);
  const Concavity concavity(solid, 0.03 * BoundsOf(block).Size().norm(), 0.02 * solid.volume);
  std::vector<int> all(solid.voxels.size());
  std::iota(all.begin(), all.end(), 0);
  const auto left_over = [&](const Cluster& cluster) {
    double sum = 0;
    for (const Cluster& piece : CutBest(solid, concavity, cluster, 0.05)) sum += piece.concavity;
    return sum;
  };
  const Cluster whole = MakeCluster(solid, concavity, all);
  Cluster by_volume_alone = whole;
  by_volume_alone.deepest = -1;
  EXPECT_GT(left_over(by_volume_alone), 0.5 * whole.concavity);
  EXPECT_LT(left_over(whole), 0.25 * whole.concavity);
}

TEST(DecomposeConvex, ThinGapsCountWhereConcavityWeighs) {
  // Five blades on a bar: the gaps between them hold little volume.
  TriMesh comb = BoxMesh({0, 0, 0}, {0.1, 0.02, 0.01});
  for (int i = 0; i < 5; ++i)
    comb = Joined(comb, BoxMesh({0.02 * i, 0, 0.005}, {0.02 * i + 0.017, 0.02, 0.04}));
  DecomposeOptions options;
  options.volume_error = 0.2;
  EXPECT_GE(DecomposeConvex(comb, options).size(), 5u);
  options.concavity = 0;
  EXPECT_LT(DecomposeConvex(comb, options).size(), 5u);
}

TEST(DecomposeConvex, FewerPartsFitWorseButStayWithinTheBound) {
  const TriMesh mesh = CrossMesh();
  double previous = 0;
  for (const int count : {12, 3, 1}) {
    DecomposeOptions options;
    options.parts = count;
    options.hull_vertices = 128;  // the cross has rounded corners
    const ConvexParts parts = DecomposeConvex(mesh, options);
    ExpectValid(parts, options);
    const double ratio = QualityOf(mesh, parts).volume_ratio;
    EXPECT_GT(ratio, previous - 0.02);
    previous = ratio;
  }
  // The hull of the whole cross with sharp corners has 114.7 of 56 units.
  EXPECT_NEAR(previous, 114.67 / 56, 0.15);
}

TEST(DecomposeConvex, ClosesAnOpenMeshFirst) {
  TriMesh mesh = ElbowMesh();
  mesh.triangles.pop_back();
  const ConvexParts parts = DecomposeConvex(mesh, {});
  ExpectValid(parts, {});
  EXPECT_NEAR(QualityOf(ElbowMesh(), parts).volume_ratio, 1, 0.1);
}

TEST(DecomposeConvex, RefusesAMeshWithoutFaces) {
  EXPECT_THROW(DecomposeConvex(TriMesh{}, {}, "nothing.stl"), Error);
}

TEST(DecomposeConvex, IsDeterministic) {
  const TriMesh mesh = CrossMesh();
  const ConvexParts a = DecomposeConvex(mesh, {}), b = DecomposeConvex(mesh, {});
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].triangles, b[i].triangles);
    EXPECT_EQ(a[i].vertices, b[i].vertices);
  }
}

TEST(QualityOf, SeesABulgeOfKnownSize) {
  const TriMesh box = BoxMesh({0, 0, 0}, {1, 1, 1});
  const ConvexParts parts = {BoxMesh({0, 0, 0}, {1, 1, 1.2})};
  const DecompositionQuality quality = QualityOf(box, parts);
  EXPECT_NEAR(quality.volume_ratio, 1.2, 1e-12);
  EXPECT_NEAR(quality.hausdorff_ratio, 0.2 / std::sqrt(3), 1e-6);
  ASSERT_EQ(quality.stick_out.size(), 1u);
  EXPECT_NEAR(quality.stick_out[0], 0.2, 1e-9);
}

TEST(QualityOf, SeesAMissingPiece) {
  const TriMesh box = BoxMesh({0, 0, 0}, {1, 1, 1});
  const ConvexParts parts = {BoxMesh({0, 0, 0}, {1, 1, 0.5}), BoxMesh({0, 0, 0.5}, {1, 0.5, 1})};
  EXPECT_NEAR(QualityOf(box, parts).hausdorff_ratio, 0.5 / std::sqrt(3), 0.02);
}

}  // namespace
}  // namespace dexremoe
