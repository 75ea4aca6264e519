// The signed distance field of an object on a regular grid, in the layout that the lanes engine
// gathers from.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/mesh.h"

namespace dexremoe {

inline constexpr int kFieldNodes = 32;  // per axis
inline constexpr int kFieldSize = kFieldNodes * kFieldNodes * kFieldNodes;

struct ObjectField {
  Eigen::Vector3f origin;   // node (0, 0, 0) in O at scale 1; m
  Eigen::Vector3f spacing;  // between nodes along x, y, z: flat objects get fine cells across; m
  float quantum;            // m per count
  // [kFieldSize], by FieldIndex: distance in counts. Small, so that a field stays in the cache; a
  // load of 32 bits reads two neighbours along z.
  std::vector<std::int16_t> nodes;
};

constexpr int FieldIndex(int x, int y, int z) { return (x * kFieldNodes + y) * kFieldNodes + z; }

// The field of the union of `parts` (closed convex meshes in O at scale 1, at least one; m). The
// grid spans the box of the parts and `margin` (m, > 0) more on each side. At the nodes:
//   outside: the exact distance to the union;
//   inside:  minus the distance to the surface of the union, so that there is nothing shallow where
//            parts abut or overlap. Faces closer than kSeam (object_surface.h) in front of or
//            inside another part may count as surface or not: the depth is right to about kSeam.
// Outside, the mean error of trilinear interpolation is then taken off the nodes
// (object_field.cpp). Equal input gives equal bytes. Throws Error when a part is not a convex body
// with outward faces.
ObjectField BuildObjectField(const ConvexParts& parts, double margin);

// Value and gradient of the field, the scalar reference of what the kernels compute.
struct FieldSample {
  double distance;           // m
  Eigen::Vector3d gradient;  // of `distance` with respect to p_O; about a unit vector
};

// Trilinear at p_O (in O at scale 1; m). Outside the grid: the value at the nearest point of the
// grid's box plus the distance to it.
FieldSample SampleField(const ObjectField& field, const Eigen::Vector3d& p_O);

}  // namespace dexremoe
