// A tree over the triangles of a mesh for nearest points and winding numbers.
#pragma once

#include <vector>

#include "geometry/mesh.h"

namespace dexremoe {

// Nearest point of a triangle (Ericson, "Real-Time Collision Detection", 5.1.5).
Eigen::Vector3d ClosestPointOnTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                       const Eigen::Vector3d& b, const Eigen::Vector3d& c);

struct SurfacePoint {
  double distance = INFINITY;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  int triangle = -1;
};

// Keeps a copy of the corners; the mesh may go away.
class TriangleBvh {
 public:
  explicit TriangleBvh(const TriMesh& mesh);

  // Nearest point of the surface. `hint` is a triangle likely to be near (-1: none): it only
  // saves time.
  SurfacePoint Closest(const Eigen::Vector3d& p, int hint = -1) const;

  // Generalised winding number (Jacobson, Kavan, Sorkine-Hornung 2013): 1 inside a closed outward
  // mesh, 0 outside, in between for open ones. Far clusters are summed as dipoles (Barill et al.
  // 2018); the error is about 0.01.
  double WindingNumber(const Eigen::Vector3d& p) const;

 private:
  struct Node {
    Box3 box;
    Eigen::Vector3d center = Eigen::Vector3d::Zero();  // area-weighted
    Eigen::Vector3d area = Eigen::Vector3d::Zero();    // summed area normals, m^2
    double radius = 0;                                 // all triangles lie within it of the centre
    int first = 0, count = 0;                          // triangles of a leaf; count 0: inner node
    int right = 0;                                     // second child; the first one follows
  };
  int Build(int first, int last);
  void Summarise(Node& node, int first, int last) const;

  struct Corners {
    Eigen::Vector3d a, b, c;
  };
  std::vector<Corners> corners_;  // in tree order
  std::vector<int> index_;        // tree order -> triangle of the mesh
  std::vector<int> place_;        // triangle of the mesh -> tree order
  std::vector<Node> nodes_;
};

// About evenly spread points on the surface, the same ones every time: equal shares of area, and
// within a triangle the R2 low-discrepancy sequence (Roberts 2018).
std::vector<Eigen::Vector3d> SpreadOverSurface(const TriMesh& mesh, int count);

}  // namespace dexremoe
