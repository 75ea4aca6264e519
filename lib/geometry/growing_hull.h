// Convex hulls that grow vertex by vertex (quickhull: Barber, Dobkin, Huhdanpaa 1996), without
// qhull's care for ill-conditioned input: ten times quicker on few points, for searches that try
// many hulls and for hulls of few vertices.
#pragma once

#include <array>
#include <vector>

#include "geometry/mesh.h"

namespace dexremoe {

class GrowingHull {
 public:
  // Starts with a large simplex of the points. The points must outlive the hull.
  explicit GrowingHull(const std::vector<Eigen::Vector3d>& points);

  // The points do not lie in a plane. Otherwise there is nothing to grow, and no volume.
  bool solid() const { return !faces_.empty(); }
  // Takes in the point farthest outside a face, again and again, until all are within rounding or
  // the hull has `max_vertices` (0: no limit).
  void Grow(int max_vertices = 0);

  double Volume() const;  // m^3
  TriMesh Mesh() const;   // closed, wound outward

 private:
  struct Face {
    std::array<int, 3> vertex;
    std::array<int, 3> beyond;  // face at the edge from vertex[k] to vertex[k + 1]
    Eigen::Vector3d normal;     // unit length
    double offset = 0;
    int first_outside = -1;  // list of points outside this face, by next_
    int farthest = -1;       // of them
    double distance = 0;     // of the farthest
    int visit = 0;           // number of the last point that saw it
    bool alive = true;
  };
  struct Edge {
    int from, to;
    int beyond;  // the face that stays
  };
  int vertices() const { return alive_ / 2 + 2; }  // Euler
  // False when the face would be degenerate or does not face away from the inside.
  bool MakeFace(int a, int b, int c, Face& face) const;
  double Above(const Face& face, int point) const {
    return face.normal.dot(points_[point]) - face.offset;
  }
  // Gives the point to the face that it is farthest outside of, among faces from `first` on.
  void Assign(int point, std::size_t first);
  void Put(int point, double distance, Face& face);
  // Collects the faces that `point` sees, from `start` on, into seen_ and the edges around them in
  // order into horizon_. False when these make no closed line.
  bool FindHorizon(int start, int point);
  // Takes in the farthest point of a face, or drops it when that would make a bad face.
  void AddFarthest(int face);

  const std::vector<Eigen::Vector3d>& points_;
  double tolerance_ = 0;
  Eigen::Vector3d inside_ = Eigen::Vector3d::Zero();
  std::vector<Face> faces_;  // dead ones included
  int alive_ = 0;
  int visits_ = 0;
  std::vector<int> next_;  // point after each point in a list; -1: none
  // Kept to save allocations.
  std::vector<int> seen_;
  std::vector<Edge> horizon_;
  std::vector<Face> fresh_;
  struct Step {
    int face, entry, done;
  };
  std::vector<Step> stack_;
};

}  // namespace dexremoe
