#include "render/gpu_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace dexremoe {
namespace {

// Index of the first vertex at the same point: exported meshes often repeat vertices per face.
std::vector<int> MergedVertices(const TriMesh& mesh) {
  const auto& v = mesh.vertices;
  std::vector<int> order(v.size()), merged(v.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int i) { return std::array{v[i].x(), v[i].y(), v[i].z()}; };
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return std::pair(key(a), a) < std::pair(key(b), b); });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && v[order[i]] == v[order[i - 1]];
    merged[order[i]] = same ? merged[order[i - 1]] : order[i];
  }
  return merged;
}

// Triangles around each vertex, as one list with offsets.
struct Fans {
  std::vector<int> offset, triangle;
};

Fans FansOf(const TriMesh& mesh, const std::vector<int>& merged) {
  Fans fans;
  fans.offset.assign(mesh.vertices.size() + 1, 0);
  for (const auto& t : mesh.triangles)
    for (int corner : t) ++fans.offset[merged[corner] + 1];
  std::partial_sum(fans.offset.begin(), fans.offset.end(), fans.offset.begin());
  fans.triangle.resize(fans.offset.back());
  std::vector<int> next(fans.offset.begin(), fans.offset.end() - 1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int corner : mesh.triangles[t]) fans.triangle[next[merged[corner]]++] = int(t);
  return fans;
}

}  // namespace

std::vector<float> ShadedCorners(const TriMesh& mesh, double crease) {
  const std::vector<int> merged = MergedVertices(mesh);
  const Fans fans = FansOf(mesh, merged);
  std::vector<Eigen::Vector3d> area(mesh.triangles.size()), unit(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Eigen::Vector3d& origin = mesh.vertices[a];
    area[t] = (mesh.vertices[b] - origin).cross(mesh.vertices[c] - origin);
    unit[t] = area[t].normalized();
  }
  const double limit = std::cos(crease);
  std::vector<float> corners;
  corners.reserve(18 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!(area[t].squaredNorm() > 0)) continue;
    for (int corner : mesh.triangles[t]) {
      Eigen::Vector3d normal = Eigen::Vector3d::Zero();
      const int at = merged[corner];
      for (int i = fans.offset[at]; i < fans.offset[at + 1]; ++i)
        if (unit[fans.triangle[i]].dot(unit[t]) >= limit) normal += area[fans.triangle[i]];
      normal = normal.squaredNorm() > 0 ? normal.normalized() : unit[t];
      for (int k = 0; k < 3; ++k) corners.push_back(float(mesh.vertices[corner][k]));
      for (int k = 0; k < 3; ++k) corners.push_back(float(normal[k]));
    }
  }
  return corners;
}

GpuMesh::GpuMesh(const Gl& gl, const TriMesh& mesh, double crease)
    : gl_(gl), bounds_(BoundingSphere(mesh)) {
  const std::vector<float> corners = ShadedCorners(mesh, crease);
  corners_ = int(corners.size() / 6);
  gl_.GenVertexArrays(1, &array_);
  gl_.GenBuffers(1, &buffer_);
  gl_.BindVertexArray(array_);
  gl_.BindBuffer(GL_ARRAY_BUFFER, buffer_);
  gl_.BufferData(GL_ARRAY_BUFFER, GLsizeiptr(corners.size() * sizeof(float)), corners.data(),
                 GL_STATIC_DRAW);
  for (GLuint attribute = 0; attribute < 2; ++attribute) {
    gl_.VertexAttribPointer(attribute, 3, GL_FLOAT, GL_FALSE, 6 * sizeof(float),
                            reinterpret_cast<const void*>(attribute * 3 * sizeof(float)));
    gl_.EnableVertexAttribArray(attribute);
  }
}

GpuMesh::~GpuMesh() {
  gl_.DeleteBuffers(1, &buffer_);
  gl_.DeleteVertexArrays(1, &array_);
}

void GpuMesh::Draw() const {
  gl_.BindVertexArray(array_);
  gl_.DrawArrays(GL_TRIANGLES, 0, corners_);
}

}  // namespace dexremoe
