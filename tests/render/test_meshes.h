// Shapes and helpers for the tests of drawing.
#pragma once

#include <cmath>

#include "geometry/mesh.h"
#include "io/png.h"

namespace dexremoe {

inline TriMesh CubeOf(double half) {
  TriMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back({i & 1 ? half : -half, i & 2 ? half : -half, i & 4 ? half : -half});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

// `n` meridians, n / 2 circles of latitude.
inline TriMesh BallOf(double radius, int n) {
  TriMesh mesh;
  const int rings = n / 2;
  mesh.vertices.push_back({0, 0, radius});
  for (int r = 1; r < rings; ++r)
    for (int k = 0; k < n; ++k) {
      const double t = M_PI * r / rings, f = 2 * M_PI * k / n;
      mesh.vertices.push_back(radius * Eigen::Vector3d(std::sin(t) * std::cos(f),
                                                       std::sin(t) * std::sin(f), std::cos(t)));
    }
  mesh.vertices.push_back({0, 0, -radius});
  const int last = int(mesh.vertices.size()) - 1;
  for (int k = 0; k < n; ++k) {
    const int next = (k + 1) % n, bottom = last - n;
    mesh.triangles.push_back({0, 1 + k, 1 + next});
    for (int r = 1; r + 1 < rings; ++r) {
      const int a = 1 + (r - 1) * n, b = a + n;
      mesh.triangles.push_back({a + k, b + k, b + next});
      mesh.triangles.push_back({a + k, b + next, a + next});
    }
    mesh.triangles.push_back({bottom + k, last, bottom + next});
  }
  return mesh;
}

inline bool SamePixel(const Image& a, const Image& b, int x, int y) {
  return a.at(x, y)[0] == b.at(x, y)[0] && a.at(x, y)[1] == b.at(x, y)[1] &&
         a.at(x, y)[2] == b.at(x, y)[2];
}

// How red a pixel is beyond grey, -255 .. 255; the same for green.
inline int Redness(const Image& image, int x, int y) {
  const auto* p = image.at(x, y);
  return p[0] - (p[1] + p[2]) / 2;
}
inline int Greenness(const Image& image, int x, int y) {
  const auto* p = image.at(x, y);
  return p[1] - (p[0] + p[2]) / 2;
}
inline int Lightness(const Image& image, int x, int y) {
  const auto* p = image.at(x, y);
  return (p[0] + p[1] + p[2]) / 3;
}

}  // namespace dexremoe
