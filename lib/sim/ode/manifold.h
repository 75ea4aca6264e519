// Contact points of two placed shapes: the supporting features of both, clipped against each other.
#pragma once

#include <Eigen/Core>
#include <array>

#include "sim/ode/gjk.h"

namespace dexremoe {

struct ManifoldPoint {
  Eigen::Vector3d position;  // halfway between the two surfaces
  double gap = 0;            // of the surfaces along the normal; negative when they overlap; m
};

struct Manifold {
  Eigen::Vector3d normal;  // unit, from b to a; the same for all points
  std::array<ManifoldPoint, 4> point;
  int size = 0;
};

// Up to four points with gap <= margin: one for a corner, two for a line (a capsule lying on a
// face, parallel edges), up to four for two faces. Features count as parallel within five degrees.
Manifold FindManifold(const PlacedShape& a, const PlacedShape& b, double margin);

}  // namespace dexremoe
