#include "hand/primitive_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dexremoe {
namespace {

constexpr int kSegments = 32;
constexpr int kCapRings = 8;

using Profile = std::vector<Eigen::Vector2d>;  // radius, z; from the bottom pole to the top pole

// Adds a triangle, turned so that its normal points away from the origin; right for every convex
// shape that contains it.
void AddOutward(TriMesh& mesh, int a, int b, int c) {
  const auto& v = mesh.vertices;
  const Eigen::Vector3d normal = (v[b] - v[a]).cross(v[c] - v[a]);
  if (normal.dot(v[a] + v[b] + v[c]) < 0) std::swap(b, c);
  mesh.triangles.push_back({a, b, c});
}

// Surface of revolution about z. The first and last point of the profile are the poles (radius 0).
TriMesh Revolve(const Profile& profile) {
  TriMesh mesh;
  const int rings = static_cast<int>(profile.size()) - 2;
  for (int ring = 0; ring < rings; ++ring)
    for (int s = 0; s < kSegments; ++s) {
      const double angle = 2 * std::numbers::pi * s / kSegments;
      const double radius = profile[ring + 1].x();
      mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle),
                                 profile[ring + 1].y());
    }
  const int bottom = rings * kSegments, top = bottom + 1;
  mesh.vertices.emplace_back(0, 0, profile.front().y());
  mesh.vertices.emplace_back(0, 0, profile.back().y());
  for (int s = 0; s < kSegments; ++s) {
    const int next = (s + 1) % kSegments;
    mesh.triangles.push_back({bottom, next, s});
    for (int ring = 0; ring + 1 < rings; ++ring) {
      const int low = ring * kSegments, high = low + kSegments;
      mesh.triangles.push_back({low + s, low + next, high + next});
      mesh.triangles.push_back({low + s, high + next, high + s});
    }
    const int last = (rings - 1) * kSegments;
    mesh.triangles.push_back({last + s, last + next, top});
  }
  return mesh;
}

// A half circle cut open at the equator and drawn apart by twice half_length.
Profile RoundProfile(double radius, double half_length) {
  Profile profile;
  for (int end = -1; end <= 1; end += 2)
    for (int k = 0; k <= kCapRings; ++k) {
      const int step = end < 0 ? k : kCapRings - k;
      const double angle = std::numbers::pi / 2 * step / kCapRings;
      profile.emplace_back(radius * std::sin(angle),
                           end * (half_length + radius * std::cos(angle)));
    }
  return profile;
}

Profile FlatProfile(double radius, double half_length) {
  const double bevel = 0.25 * std::min(radius, half_length);
  const double inner = radius - bevel, low = half_length - bevel;
  return {{0, -half_length}, {inner, -half_length}, {radius, -low},
          {radius, low},     {inner, half_length},  {0, half_length}};
}

}  // namespace

TriMesh BoxMesh(const Eigen::Vector3d& size) {
  const double bevel = std::min(0.04 * size.maxCoeff(), 0.25 * size.minCoeff());
  const Eigen::Vector3d outer = size / 2;
  TriMesh mesh;
  // Three vertices at each corner, one per face; number = 3 * corner + axis of the face.
  for (int corner = 0; corner < 8; ++corner)
    for (int axis = 0; axis < 3; ++axis) {
      Eigen::Vector3d p = outer - Eigen::Vector3d::Constant(bevel);
      p[axis] = outer[axis];
      for (int k = 0; k < 3; ++k)
        if (corner & (1 << k)) p[k] = -p[k];
      mesh.vertices.push_back(p);
    }
  for (int axis = 0; axis < 3; ++axis) {
    const int u = 1 << ((axis + 1) % 3), v = 1 << ((axis + 2) % 3);
    for (int side = 0; side < 2; ++side) {  // the six faces
      const int c = side << axis;
      AddOutward(mesh, 3 * c + axis, 3 * (c | u) + axis, 3 * (c | u | v) + axis);
      AddOutward(mesh, 3 * c + axis, 3 * (c | u | v) + axis, 3 * (c | v) + axis);
    }
    for (int edge = 0; edge < 4; ++edge) {  // the four bevels along this axis
      const int a = ((edge & 1) ? u : 0) | ((edge & 2) ? v : 0), b = a | (1 << axis);
      const int f = (axis + 1) % 3, g = (axis + 2) % 3;
      AddOutward(mesh, 3 * a + f, 3 * a + g, 3 * b + g);
      AddOutward(mesh, 3 * a + f, 3 * b + g, 3 * b + f);
    }
  }
  for (int corner = 0; corner < 8; ++corner)
    AddOutward(mesh, 3 * corner, 3 * corner + 1, 3 * corner + 2);
  return mesh;
}

TriMesh CylinderMesh(double radius, double length, bool round_ends) {
  return Revolve(round_ends ? RoundProfile(radius, length / 2) : FlatProfile(radius, length / 2));
}

TriMesh SphereMesh(double radius) {
  Profile profile = RoundProfile(radius, 0);
  profile.erase(profile.begin() + kCapRings);  // the equator stands twice
  return Revolve(profile);
}

void Append(const TriMesh& mesh, const Pose& X_AB, TriMesh& target) {
  const int first = static_cast<int>(target.vertices.size());
  for (const Eigen::Vector3d& p : mesh.vertices) target.vertices.push_back(X_AB * p);
  for (const auto& t : mesh.triangles)
    target.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

}  // namespace dexremoe
