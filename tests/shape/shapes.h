// Simple meshes and clouds built in code.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "base/random.h"
#include "geometry/mesh.h"
#include "shape/shape_net.h"

namespace dexremoe {

// A closed box centred at the origin; two triangles a side, sides in the order -x +x -y +y -z +z.
inline TriMesh BoxMesh(const Eigen::Vector3d& size) {
  TriMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back(
        Eigen::Vector3d(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5)
            .cwiseProduct(size));
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return mesh;
}

// A sphere around the origin of rings x 2 rings quads, split.
inline TriMesh SphereMesh(double radius, int rings) {
  TriMesh mesh;
  const int around = 2 * rings;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j < around; ++j) {
      const double theta = M_PI * i / rings, phi = 2 * M_PI * j / around;
      mesh.vertices.emplace_back(radius * std::sin(theta) * std::cos(phi),
                                 radius * std::sin(theta) * std::sin(phi),
                                 radius * std::cos(theta));
    }
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < around; ++j) {
      const int a = i * around + j, b = i * around + (j + 1) % around;
      mesh.triangles.push_back({a, a + around, b + around});
      mesh.triangles.push_back({a, b + around, b});
    }
  return mesh;
}

// Points drawn at random from a solid box: no ties between distances.
inline std::vector<Eigen::Vector3f> RandomCloud(int count, std::uint64_t index,
                                                const Eigen::Vector3f& size = {1, 0.7f, 0.4f}) {
  Rng rng(17, Stream::kTest, {index});
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < count; ++i) {
    Eigen::Vector3f p;
    for (int k = 0; k < 3; ++k) p[k] = size[k] * static_cast<float>(rng.Uniform(-1, 1));
    points.push_back(p);
  }
  return points;
}

inline void InitializeOnRandomClouds(ShapeNet& net, Rng& rng) {
  std::vector<GroupedCloud> clouds;
  for (std::uint64_t i = 0; i < 8; ++i)
    clouds.push_back(net.net.Group(
        RandomCloud(net.net.sizes().points, 1000 + i, {1, 0.9f - 0.1f * i, 0.2f + 0.1f * i})));
  net.net.Initialize(rng, clouds, net.params.data());
}

}  // namespace dexremoe
