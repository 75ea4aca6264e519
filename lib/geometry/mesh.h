// Triangle meshes and convex parts.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <vector>

namespace dexremoe {

struct TriMesh {
  std::vector<Eigen::Vector3d> vertices;      // m
  std::vector<std::array<int, 3>> triangles;  // counter-clockwise from outside
};

struct Box3 {
  Eigen::Vector3d min = Eigen::Vector3d::Constant(INFINITY);
  Eigen::Vector3d max = Eigen::Vector3d::Constant(-INFINITY);
  Eigen::Vector3d Size() const { return max - min; }
  Eigen::Vector3d Center() const { return (min + max) / 2; }
  void Extend(const Eigen::Vector3d& point) {
    min = min.cwiseMin(point);
    max = max.cwiseMax(point);
  }
};

Box3 BoundsOf(const TriMesh& mesh);

// Volume integrals of a closed mesh of unit density (divergence theorem; Eberly, "Polyhedral Mass
// Properties", 2002).
struct MassProperties {
  double volume = 0;                                  // m^3
  Eigen::Vector3d center = Eigen::Vector3d::Zero();   // m
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // about the centre; m^5 (density 1)
};
MassProperties MassPropertiesOf(const TriMesh& mesh);

// A convex decomposition: every part is a closed convex mesh.
using ConvexParts = std::vector<TriMesh>;

// Vertex normals, area weighted, unit length.
std::vector<Eigen::Vector3d> VertexNormals(const TriMesh& mesh);

}  // namespace dexremoe
