// Convex shapes as the narrow phase sees them: a core (point, segment or polytope) and a radius.
//
// A sphere is a point with a radius, a capsule a segment with a radius, boxes and hulls are
// polytopes with radius 0. All contact geometry works on cores; radii are subtracted at the end.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/pose.h"
#include "hand/hand_model.h"

namespace dexremoe {

struct ConvexFace {
  Eigen::Vector3d normal;  // outward, unit
  double offset = 0;       // normal . x on the face; m
  std::vector<int> loop;   // vertex indices, counter-clockwise from outside
};

struct ConvexShape {
  std::vector<double> x, y, z;                       // core vertices; m
  std::vector<ConvexFace> faces;                     // empty for points and segments
  std::vector<std::array<int, 2>> edges;             // between different faces
  double radius = 0;                                 // rounding radius; m
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // of the bounding sphere; inside the core
  double bound = 0;  // bounding sphere of core and rounding about center; m
  Box3 box;          // of the core; m

  int size() const { return static_cast<int>(x.size()); }
  Eigen::Vector3d Vertex(int i) const { return {x[i], y[i], z[i]}; }
  // Index of the core vertex farthest along direction.
  int Support(const Eigen::Vector3d& direction) const;
};

// The shape of a closed convex mesh; triangles whose normals differ by less than one degree become
// one face. `what` names the mesh in errors. Throws Error when it is not a closed convex body.
ConvexShape ShapeOfHull(const TriMesh& mesh, const std::string& what);
// The shape of a hand collider, in its collider frame.
ConvexShape ShapeOfCollider(const Collider& collider);

// A shape at a pose, its core scaled about the origin of its own frame. Only p_*, R and the scale
// vary; the shape is shared.
struct PlacedShape {
  const ConvexShape* shape = nullptr;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  double scale = 1;
  bool identity = false;  // R = 1, p = 0: skip the products

  Eigen::Vector3d Place(const Eigen::Vector3d& local) const {
    if (identity) return scale * local;
    return R * (scale * local) + p;
  }
  Eigen::Vector3d ToLocalDirection(const Eigen::Vector3d& direction) const {
    if (identity) return direction;
    return R.transpose() * direction;
  }
  Eigen::Vector3d ToCommonDirection(const Eigen::Vector3d& local) const {
    if (identity) return local;
    return R * local;
  }
  int SupportIndex(const Eigen::Vector3d& direction) const {
    return shape->Support(ToLocalDirection(direction));
  }
  Eigen::Vector3d Vertex(int i) const { return Place(shape->Vertex(i)); }
};

}  // namespace dexremoe
