#include "geometry/mesh.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "geometry/repair.h"
#include "shapes.h"

namespace dexremoe {
namespace {

TEST(MassProperties, OfABoxMatchClosedForm) {
  const Eigen::Vector3d size(0.3, 0.2, 0.1), at(5, -7, 2);
  const MassProperties p = MassPropertiesOf(BoxMesh(at - size / 2, at + size / 2));
  const double v = size.prod();
  EXPECT_NEAR(p.volume, v, 1e-12);
  EXPECT_LT((p.center - at).norm(), 1e-12);
  for (int k = 0; k < 3; ++k) {
    const double b = size[(k + 1) % 3], c = size[(k + 2) % 3];
    EXPECT_NEAR(p.inertia(k, k), v / 12 * (b * b + c * c), 1e-14);
  }
  EXPECT_NEAR(p.inertia(0, 1), 0, 1e-14);
}

TEST(MassProperties, OfASphereConvergeQuadratically) {
  const double r = 0.05, volume = 4.0 / 3 * std::numbers::pi * r * r * r;
  double previous = 0;
  for (const int n : {8, 16, 32}) {
    const MassProperties p = MassPropertiesOf(SphereMesh(r, n));
    const double error = 1 - p.volume / volume;
    EXPECT_GT(error, 0);  // inscribed
    if (previous > 0) {
      EXPECT_NEAR(previous / error, 4, 0.3);
    }
    previous = error;
    EXPECT_NEAR(p.inertia(0, 0) / (0.4 * p.volume * r * r), 1, 2 * error);
  }
}

TEST(MassProperties, FollowRotationAndScale) {
  const TriMesh mesh = ElbowMesh();
  const MassProperties p = MassPropertiesOf(mesh);
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const Eigen::Vector3d shift(0.1, -0.2, 0.3);
  const double s = 1.7;
  const MassProperties q = MassPropertiesOf(Transformed(mesh, s * R, shift));
  EXPECT_NEAR(q.volume, s * s * s * p.volume, 1e-12);
  EXPECT_LT((q.center - (s * (R * p.center) + shift)).norm(), 1e-12);
  EXPECT_LT((q.inertia - std::pow(s, 5) * R * p.inertia * R.transpose()).norm(),
            1e-9 * q.inertia.norm());
}

TEST(MassProperties, OfDisjointSolidsAddUp) {
  const TriMesh a = BoxMesh({0, 0, 0}, {1, 1, 1}), b = BoxMesh({3, 0, 0}, {4, 2, 1});
  const MassProperties p = MassPropertiesOf(Joined(a, b));
  EXPECT_NEAR(p.volume, 3, 1e-12);
  EXPECT_LT((p.center - Eigen::Vector3d(0.5 + 7, 0.5 + 2, 1.5) / 3).norm(), 1e-12);
}

TEST(VertexNormals, OfASpherePointOutward) {
  const TriMesh mesh = SphereMesh(2, 24);
  const auto normals = VertexNormals(mesh);
  for (std::size_t i = 0; i < normals.size(); ++i)
    EXPECT_GT(normals[i].dot(mesh.vertices[i].normalized()), 0.98);
}

TEST(Weld, MakesATriangleListClosed) {
  const TriMesh box = BoxMesh({0, 0, 0}, {1, 2, 3});
  TriMesh list;  // every triangle with corners of its own, moved by rounding
  Rng rng(1, Stream::kTest);
  for (const auto& t : box.triangles) {
    const int first = static_cast<int>(list.vertices.size());
    for (const int v : t)
      list.vertices.push_back(box.vertices[v] + 1e-7 * Eigen::Vector3d(rng.Normal(), 0, 0));
    list.triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_EQ(TopologyOf(list).open_edges, 36);
  const TriMesh welded = Weld(list, 1e-5);
  EXPECT_EQ(welded.vertices.size(), 8u);
  EXPECT_TRUE(TopologyOf(welded).ClosedManifold());
}

TEST(Topology, CountsWhatIsWrong) {
  TriMesh box = BoxMesh({0, 0, 0}, {1, 1, 1});
  EXPECT_TRUE(TopologyOf(box).ClosedManifold());
  EXPECT_EQ(TopologyOf(Joined(box, box)).shells, 2);
  // Two boxes that share one corner: manifold edges, a pinched vertex.
  const TriMesh touching = Weld(Joined(box, BoxMesh({1, 1, 1}, {2, 2, 2})), 0);
  EXPECT_EQ(TopologyOf(touching).pinched_vertices, 1);
  // Two boxes that share an edge: four triangles there.
  const TriMesh hinged = Weld(Joined(box, BoxMesh({1, 1, 0}, {2, 2, 1})), 0);
  EXPECT_EQ(TopologyOf(hinged).crowded_edges, 1);
  std::swap(box.triangles[0][0], box.triangles[0][1]);
  EXPECT_EQ(TopologyOf(box).flipped_edges, 3);
  EXPECT_TRUE(TopologyOf(WithConsistentWinding(box)).ClosedManifold());
  box.triangles.pop_back();
  EXPECT_EQ(TopologyOf(box).open_edges, 3);
}

}  // namespace
}  // namespace dexremoe
