// Meshes that several tests use.
#pragma once

#include <cmath>
#include <numbers>

#include "geometry/hull.h"
#include "geometry/mesh.h"
#include "geometry/remesh.h"
#include "geometry/repair.h"

namespace dexremoe {

inline TriMesh BoxMesh(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  TriMesh mesh;
  for (int c = 0; c < 8; ++c)
    mesh.vertices.emplace_back(c & 1 ? high.x() : low.x(), c & 2 ? high.y() : low.y(),
                               c & 4 ? high.z() : low.z());
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return mesh;
}

// Rings of a sphere of `radius`, 2n around and n from pole to pole.
inline TriMesh SphereMesh(double radius, int n) {
  TriMesh mesh;
  const auto at = [&](int i, int j) {
    const double polar = std::numbers::pi * i / n, turn = std::numbers::pi * (j % (2 * n)) / n;
    if (i == 0 || i == n) return Eigen::Vector3d(0, 0, i == 0 ? radius : -radius);
    return Eigen::Vector3d(radius * std::sin(polar) * std::cos(turn),
                           radius * std::sin(polar) * std::sin(turn), radius * std::cos(polar));
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 2 * n; ++j) {
      const int first = static_cast<int>(mesh.vertices.size());
      for (const auto& p : {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)})
        mesh.vertices.push_back(p);
      if (i + 1 < n) mesh.triangles.push_back({first, first + 1, first + 2});
      if (i > 0) mesh.triangles.push_back({first, first + 2, first + 3});
    }
  return Weld(mesh, 0);
}

inline TriMesh Joined(const TriMesh& a, const TriMesh& b) {
  TriMesh mesh = a;
  const int first = static_cast<int>(a.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (auto t : b.triangles) {
    for (int& index : t) index += first;
    mesh.triangles.push_back(t);
  }
  return mesh;
}

inline TriMesh Transformed(TriMesh mesh, const Eigen::Matrix3d& linear,
                           const Eigen::Vector3d& shift) {
  for (auto& v : mesh.vertices) v = linear * v + shift;
  return mesh;
}

// An L: a 3 x 1 x 1 bar and a 1 x 1 x 2 post on its end, extruded as one closed mesh (cm).
inline TriMesh ElbowMesh() {
  const std::vector<Eigen::Vector2d> outline = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}};
  TriMesh mesh;
  const int n = static_cast<int>(outline.size());
  for (const double y : {0.0, 1.0})
    for (const auto& p : outline) mesh.vertices.emplace_back(0.01 * p.x(), 0.01 * y, 0.01 * p.y());
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    mesh.triangles.push_back({i, j, n + j});
    mesh.triangles.push_back({i, n + j, n + i});
  }
  for (const auto& t :
       std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}) {
    mesh.triangles.push_back({t[2], t[1], t[0]});
    mesh.triangles.push_back({n + t[0], n + t[1], n + t[2]});
  }
  return WithConsistentWinding(mesh);
}

inline bool IsConvex(const TriMesh& part, double tolerance) {
  for (const auto& v : part.vertices)
    if (DistanceOutside(part, v) > tolerance) return false;
  return true;
}

}  // namespace dexremoe
