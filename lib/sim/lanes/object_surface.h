// The union of convex parts: its surface and the signed distance to it.
#pragma once

#include <vector>

#include "geometry/mesh.h"
#include "geometry/triangle_bvh.h"

namespace dexremoe {

// Plane of a face: normal . p = offset, the normal unit and outward.
struct FacePlane {
  Eigen::Vector3d normal;
  double offset;  // m
};

// The distinct face planes of a closed convex mesh and its box.
struct ConvexBody {
  std::vector<FacePlane> planes;
  Box3 box;
};
// Throws Error when it has no volume or its faces point inwards.
ConvexBody BodyOf(const TriMesh& part);

// Gaps narrower than this between parts count as closed; m.
inline constexpr double kSeam = 0.5e-3;

// The faces of all parts without the pieces that lie inside the union. A piece is inside when the
// point kSeam in front of it is in another part. So faces where parts abut, overlap or leave a
// narrow gap go, and faces flush with those of another part stay (once for each part). Pieces less
// than kSeam under the union's surface may stay too. The pieces are triangles without common
// vertices.
TriMesh UnionSurface(const ConvexParts& parts);

// Signed distance to the union: outside exact, inside to UnionSurface. Points in narrow gaps
// between parts count as inside. One object per thread: it remembers the last triangle as a guess,
// so it is quickest for points that follow each other closely.
class UnionDistance {
 public:
  explicit UnionDistance(const ConvexParts& parts);
  bool Inside(const Eigen::Vector3d& p) const;                              // in any part
  double Signed(const Eigen::Vector3d& p) { return Signed(p, Inside(p)); }  // m
  double Signed(const Eigen::Vector3d& p, bool inside);                     // Inside(p) known

 private:
  // The nearest triangle, starting from that of the call before.
  struct Nearest {
    TriangleBvh tree;
    int hint = -1;
    double Distance(const Eigen::Vector3d& p);
  };
  std::vector<ConvexBody> bodies_;
  Nearest faces_;    // all faces of all parts
  Nearest surface_;  // UnionSurface
};

}  // namespace dexremoe
