#include "geometry/remesh.h"

namespace dexremoe {

void ProjectToField(const std::function<double(const Eigen::Vector3d&)>& field, double step,
                    double reach, TriMesh& mesh) {
  for (Eigen::Vector3d& vertex : mesh.vertices) {
    const Eigen::Vector3d start = vertex;
    for (int iteration = 0; iteration < 3; ++iteration) {
      Eigen::Vector3d gradient;
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d d = step * Eigen::Vector3d::Unit(k);
        gradient[k] = (field(vertex + d) - field(vertex - d)) / (2 * step);
      }
      const double squared = gradient.squaredNorm();
      if (!(squared > 1e-4)) break;  // a ridge of the field: no direction to go
      const Eigen::Vector3d moved = vertex - field(vertex) / squared * gradient;
      if (!((moved - start).norm() <= reach)) break;
      vertex = moved;
    }
  }
}

void SmoothTangentially(int rounds, TriMesh& mesh) {
  for (int round = 0; round < rounds; ++round) {
    const std::vector<Eigen::Vector3d> normals = VertexNormals(mesh);
    std::vector<Eigen::Vector3d> sum(mesh.vertices.size(), Eigen::Vector3d::Zero());
    std::vector<int> count(mesh.vertices.size(), 0);
    for (const auto& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) {  // every edge is seen once from each of its triangles
        sum[t[k]] += mesh.vertices[t[(k + 1) % 3]];
        ++count[t[k]];
      }
    for (std::size_t i = 0; i < sum.size(); ++i) {
      if (count[i] == 0) continue;
      const Eigen::Vector3d move = (sum[i] / count[i] - mesh.vertices[i]) / 2;
      mesh.vertices[i] += move - normals[i].dot(move) * normals[i];
    }
  }
}

}  // namespace dexremoe
