// Closed meshes of the simple shapes that URDF files know, with bevelled edges so that smooth
// shading looks like machined parts.
#pragma once

#include "geometry/mesh.h"
#include "geometry/pose.h"

namespace dexremoe {

// Axis-aligned box about the origin. The bevel is 4 % of the longest side, at most a quarter of the
// shortest; 44 triangles. size in m.
TriMesh BoxMesh(const Eigen::Vector3d& size);

// Cylinder (capsule when `round_ends`, then `length` is the distance of the cap centres) about the
// origin along z. radius and length in m.
TriMesh CylinderMesh(double radius, double length, bool round_ends);

// Sphere about the origin. radius in m.
TriMesh SphereMesh(double radius);

// Adds `mesh`, moved by X_AB, to `target` (both triangle lists; no merging).
void Append(const TriMesh& mesh, const Pose& X_AB, TriMesh& target);

}  // namespace dexremoe
