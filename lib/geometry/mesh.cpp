#include "geometry/mesh.h"

namespace dexremoe {

Box3 BoundsOf(const TriMesh& mesh) {
  Box3 bounds;
  for (const Eigen::Vector3d& vertex : mesh.vertices) bounds.Extend(vertex);
  return bounds;
}

MassProperties MassPropertiesOf(const TriMesh& mesh) {
  MassProperties result;
  if (mesh.triangles.empty()) return result;
  // Tetrahedra from each triangle to a point near the mesh: their signed volumes then do not
  // cancel badly when the mesh is far from the origin.
  const Eigen::Vector3d apex = BoundsOf(mesh).Center();
  double volume = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();   // integral of x
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  // integral of x x^T
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[triangle[0]] - apex;
    const Eigen::Vector3d b = mesh.vertices[triangle[1]] - apex;
    const Eigen::Vector3d c = mesh.vertices[triangle[2]] - apex;
    const double six_volumes = a.dot(b.cross(c));
    const Eigen::Vector3d sum = a + b + c;
    volume += six_volumes / 6;
    first += six_volumes / 24 * sum;
    second += six_volumes / 120 *
              (sum * sum.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  result.volume = volume;
  if (volume == 0) return result;
  const Eigen::Vector3d center = first / volume;
  const Eigen::Matrix3d central = second - volume * center * center.transpose();
  result.center = apex + center;
  result.inertia = central.trace() * Eigen::Matrix3d::Identity() - central;
  return result;
}

std::vector<Eigen::Vector3d> VertexNormals(const TriMesh& mesh) {
  std::vector<Eigen::Vector3d> normals(mesh.vertices.size(), Eigen::Vector3d::Zero());
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3d& a = mesh.vertices[triangle[0]];
    const Eigen::Vector3d twice_area =
        (mesh.vertices[triangle[1]] - a).cross(mesh.vertices[triangle[2]] - a);
    for (const int vertex : triangle) normals[vertex] += twice_area;
  }
  for (Eigen::Vector3d& normal : normals) {
    const double length = normal.norm();
    // A vertex without area (or where faces cancel) still needs a unit vector.
    normal = length > 0 ? Eigen::Vector3d(normal / length) : Eigen::Vector3d::UnitZ();
  }
  return normals;
}

}  // namespace dexremoe
