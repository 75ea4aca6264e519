#include "sim/ode/convex.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/error.h"

namespace dexremoe {
namespace {

using Eigen::Vector3d;
using Edge = std::pair<int, int>;

constexpr double kCoplanarCosine = 0.99985;  // one degree

void AddVertex(ConvexShape& shape, const Vector3d& vertex) {
  shape.x.push_back(vertex.x());
  shape.y.push_back(vertex.y());
  shape.z.push_back(vertex.z());
  shape.box.Extend(vertex);
}

void SetBounds(ConvexShape& shape) {
  shape.center = shape.box.Center();
  double farthest = 0;
  for (int i = 0; i < shape.size(); ++i)
    farthest = std::max(farthest, (shape.Vertex(i) - shape.center).norm());
  shape.bound = farthest + shape.radius;
}

// Keeps the vertices that triangles use, so that a support point is always a corner.
std::vector<std::array<int, 3>> AddUsedVertices(ConvexShape& shape, const TriMesh& mesh,
                                                const std::string& what) {
  std::vector<int> index(mesh.vertices.size(), -1);
  std::vector<std::array<int, 3>> triangles = mesh.triangles;
  for (auto& triangle : triangles)
    for (int& corner : triangle) {
      if (corner < 0 || corner >= static_cast<int>(mesh.vertices.size()))
        Fail("{}: triangle: expected vertex 0..{}, found {}", what, mesh.vertices.size(), corner);
      if (index[corner] < 0) {
        index[corner] = shape.size();
        AddVertex(shape, mesh.vertices[corner]);
      }
      corner = index[corner];
    }
  return triangles;
}

// Groups triangles into faces: a flood over edges that stays near the first triangle's normal.
std::vector<int> GroupCoplanar(const std::vector<Vector3d>& normals,
                               const std::vector<std::array<int, 3>>& triangles,
                               const std::map<Edge, int>& triangle_at, const std::string& what) {
  std::vector<int> group(triangles.size(), -1), stack;
  int groups = 0;
  for (std::size_t seed = 0; seed < triangles.size(); ++seed) {
    if (group[seed] >= 0) continue;
    stack.assign(1, static_cast<int>(seed));
    group[seed] = groups;
    while (!stack.empty()) {
      const int t = stack.back();
      stack.pop_back();
      for (int k = 0; k < 3; ++k) {
        const auto next = triangle_at.find({triangles[t][(k + 1) % 3], triangles[t][k]});
        if (next == triangle_at.end())
          Fail("{}: expected a closed convex mesh, found an open edge", what);
        if (group[next->second] >= 0) continue;
        if (normals[next->second].dot(normals[seed]) < kCoplanarCosine) continue;
        group[next->second] = groups;
        stack.push_back(next->second);
      }
    }
    ++groups;
  }
  return group;
}

// Chains the boundary edges of one group of triangles to a loop; empty when it is not one loop.
std::vector<int> ChainLoop(const std::map<int, int>& next) {
  std::vector<int> loop;
  int at = next.begin()->first;
  do {
    loop.push_back(at);
    const auto step = next.find(at);
    if (step == next.end() || loop.size() > next.size()) return {};
    at = step->second;
  } while (at != loop.front());
  if (loop.size() != next.size()) return {};
  return loop;
}

void AddFaces(ConvexShape& shape, const std::vector<std::array<int, 3>>& triangles,
              const std::string& what) {
  std::map<Edge, int> triangle_at;
  std::vector<Vector3d> normals, area_normals;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    const Vector3d cross =
        (shape.Vertex(b) - shape.Vertex(a)).cross(shape.Vertex(c) - shape.Vertex(a));
    area_normals.push_back(cross);
    normals.push_back(cross.normalized());
    for (int k = 0; k < 3; ++k)
      triangle_at[{triangles[t][k], triangles[t][(k + 1) % 3]}] = static_cast<int>(t);
  }
  const std::vector<int> group = GroupCoplanar(normals, triangles, triangle_at, what);
  const int groups = 1 + *std::max_element(group.begin(), group.end());
  for (int g = 0; g < groups; ++g) {
    std::map<int, int> next;
    ConvexFace face;
    face.normal.setZero();
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      if (group[t] != g) continue;
      face.normal += area_normals[t];
      for (int k = 0; k < 3; ++k) {
        const Edge edge(triangles[t][k], triangles[t][(k + 1) % 3]);
        if (group[triangle_at.at({edge.second, edge.first})] == g) continue;
        next[edge.first] = edge.second;
        if (edge.first < edge.second) shape.edges.push_back({edge.first, edge.second});
      }
    }
    face.loop = next.empty() ? std::vector<int>() : ChainLoop(next);
    if (face.loop.size() < 3) Fail("{}: expected convex faces, found one without a border", what);
    face.normal.normalize();
    for (const int i : face.loop) face.offset += face.normal.dot(shape.Vertex(i));
    face.offset /= static_cast<double>(face.loop.size());
    shape.faces.push_back(std::move(face));
  }
}

TriMesh BoxMesh(const Vector3d& half) {
  TriMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back(i & 1 ? half.x() : -half.x(), i & 2 ? half.y() : -half.y(),
                               i & 4 ? half.z() : -half.z());
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

}  // namespace

int ConvexShape::Support(const Vector3d& direction) const {
  const double dx = direction.x(), dy = direction.y(), dz = direction.z();
  const int count = size();
  int best = 0;
  double farthest = -INFINITY;
  for (int i = 0; i < count; ++i) {
    const double along = x[i] * dx + y[i] * dy + z[i] * dz;
    if (along > farthest) {
      farthest = along;
      best = i;
    }
  }
  return best;
}

ConvexShape ShapeOfHull(const TriMesh& mesh, const std::string& what) {
  if (mesh.triangles.size() < 4)
    Fail("{}: expected at least 4 triangles, found {}", what, mesh.triangles.size());
  for (const Vector3d& vertex : mesh.vertices)
    if (!vertex.allFinite()) Fail("{}: expected finite vertices", what);
  ConvexShape shape;
  AddFaces(shape, AddUsedVertices(shape, mesh, what), what);
  SetBounds(shape);
  return shape;
}

ConvexShape ShapeOfCollider(const Collider& collider) {
  ConvexShape shape;
  switch (collider.shape) {
    case ColliderShape::kSphere:
      AddVertex(shape, Vector3d::Zero());
      shape.radius = collider.radius;
      break;
    case ColliderShape::kCapsule:
      AddVertex(shape, Vector3d(0, 0, -collider.half_length));
      AddVertex(shape, Vector3d(0, 0, collider.half_length));
      shape.radius = collider.radius;
      break;
    case ColliderShape::kBox:
      return ShapeOfHull(BoxMesh(collider.half_size), "collider " + collider.name);
    case ColliderShape::kHull:
      return ShapeOfHull(collider.hull, "collider " + collider.name);
  }
  SetBounds(shape);
  return shape;
}

}  // namespace dexremoe
