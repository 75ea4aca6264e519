#include "sim/lanes/hull_boxes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <set>

#include "base/check.h"
#include "sim/lanes/object_surface.h"

namespace dexremoe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kLeastHalf = 0.5e-3;  // m; smaller half extents become 0
constexpr double kSameFace = 0.9999;   // cosine between normals
constexpr double kSame = 0.5e-3;       // m; boxes that differ less count as one

double DepthIn(const ConvexBody& body, const Vector3d& p) {
  double depth = INFINITY;
  for (const FacePlane& plane : body.planes)
    depth = std::min(depth, plane.offset - plane.normal.dot(p));
  return depth;
}

// About the centre of the largest inner ball: pattern search over 26 directions.
Vector3d DeepestPoint(const ConvexBody& body, Vector3d p) {
  double depth = DepthIn(body, p);
  for (double step = body.box.Size().maxCoeff() / 4; step > 1e-5; step /= 2)
    for (int direction = 0; direction < 27;) {
      const Vector3d next =
          p + step * Vector3d(direction % 3 - 1, direction / 3 % 3 - 1, direction / 9 - 1);
      const double deeper = DepthIn(body, next);
      ++direction;
      if (deeper <= depth) continue;
      depth = deeper;
      p = next;
      direction = 0;
    }
  return p;
}

Vector3d AreaOf(const TriMesh& hull, const std::array<int, 3>& triangle) {
  const Vector3d& a = hull.vertices[triangle[0]];
  return (hull.vertices[triangle[1]] - a).cross(hull.vertices[triangle[2]] - a) / 2;
}

// Normal of the face, triangles in one plane taken together, that has most area.
Vector3d LargestFace(const TriMesh& hull) {
  Vector3d best = Vector3d::UnitX();
  double largest = 0;
  for (const auto& triangle : hull.triangles) {
    const Vector3d normal = AreaOf(hull, triangle).normalized();
    double area = 0;
    for (const auto& other : hull.triangles) {
      const Vector3d theirs = AreaOf(hull, other);
      if (theirs.dot(normal) > kSameFace * theirs.norm()) area += theirs.norm();
    }
    if (area <= largest) continue;
    largest = area;
    best = normal;
  }
  return best;
}

// Frame along `normal` with the smallest rectangle around the hull's shadow on that plane; one of
// its sides is along an edge.
Matrix3d FrameOn(const TriMesh& hull, const Vector3d& normal) {
  Matrix3d best = Matrix3d::Identity();
  double least = INFINITY;
  for (const auto& triangle : hull.triangles)
    for (int k = 0; k < 3; ++k) {
      Vector3d edge = hull.vertices[triangle[(k + 1) % 3]] - hull.vertices[triangle[k]];
      edge -= normal * normal.dot(edge);
      if (!(edge.norm() > kLeastHalf)) continue;
      Matrix3d frame;
      frame.col(0) = normal;
      frame.col(1) = edge.normalized();
      frame.col(2) = frame.col(0).cross(frame.col(1));
      Box3 box;
      for (const Vector3d& p : hull.vertices) box.Extend(frame.transpose() * p);
      const double area = box.Size().y() * box.Size().z();
      if (area >= least) continue;
      least = area;
      best = frame;
    }
  return best;
}

// The hull's own frame, its principal axes, and a frame on its largest face.
std::vector<Matrix3d> Orientations(const TriMesh& hull) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> inertia(MassPropertiesOf(hull).inertia);
  Matrix3d principal = inertia.eigenvectors();
  if (principal.determinant() < 0) principal.col(0) *= -1;
  return {Matrix3d::Identity(), principal, FrameOn(hull, LargestFace(hull))};
}

constexpr double kTowardsVertex = 0.7;  // of the way

// A box that touches one plane cannot grow along another that is only nearly parallel, so the last
// bit of even growth is left to the sides one by one.
constexpr double kFirstGrowth = 0.95;
constexpr double kParallel = 1e-9;

// The hull's planes moved inwards, in the box's axes: where the core of a rounded box may be.
class Room {
 public:
  Room(const ConvexBody& body, const Matrix3d& axes, double inwards) {
    for (const FacePlane& plane : body.planes)
      planes_.push_back({axes.transpose() * plane.normal, plane.offset - inwards});
  }

  // How many times `way` can be walked from p.
  double Walk(const Vector3d& p, const Vector3d& way) const {
    double most = INFINITY;
    for (const FacePlane& plane : planes_) {
      const double slope = plane.normal.dot(way);
      if (slope > 0) most = std::min(most, (plane.offset - plane.normal.dot(p)) / slope);
    }
    return most;
  }

  // Blows the box up evenly along some axes (bits), nearly until it touches a plane, then moves the
  // sides across other axes (bits) outwards as far as they go, in the order given.
  Box3 Grow(const Vector3d& seed, int even, int sides, const std::array<int, 3>& order) const {
    const Vector3d shape(even & 1, even >> 1 & 1, even >> 2);
    double most = INFINITY;
    for (const FacePlane& plane : planes_) {
      const double reach = plane.normal.cwiseAbs().dot(shape);
      if (reach > 0) most = std::min(most, (plane.offset - plane.normal.dot(seed)) / reach);
    }
    most *= kFirstGrowth;
    Box3 box = {seed - most * shape, seed + most * shape};
    for (const int axis : order) {
      if (!(sides >> axis & 1)) continue;
      double up = INFINITY, down = INFINITY;
      for (const FacePlane& plane : planes_) {
        const Vector3d corner = (plane.normal.array() > 0).select(box.max, box.min);
        const double slack = std::max(0.0, plane.offset - plane.normal.dot(corner));
        const double slope = plane.normal[axis];
        if (slope > kParallel) up = std::min(up, slack / slope);
        if (slope < -kParallel) down = std::min(down, -slack / slope);
      }
      box.max[axis] += up;
      box.min[axis] -= down;
    }
    return box;
  }

 private:
  std::vector<FacePlane> planes_;
};

RoundedBox MakeBox(const Box3& core, const Matrix3d& axes, double radius) {
  RoundedBox box;
  box.center = axes * core.Center();
  box.radius = radius;
  const Vector3d half = core.Size() / 2;
  std::array<int, 3> order = {0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return half[a] > half[b]; });
  for (int k = 0; k < 3; ++k) {
    box.axes.col(k) = axes.col(order[k]);
    box.half[k] = half[order[k]] < kLeastHalf ? 0 : half[order[k]];
  }
  if (box.axes.determinant() < 0) box.axes.col(2) *= -1;
  return box;
}

// Roundings to try where the largest ball that fits has radius `thick`: a thin hull is thinner
// still in other places.
std::vector<double> Radii(double thick, double aim) {
  if (thick < aim) return {thick, thick / 2};
  if (thick < 2 * aim) return {thick, aim, aim / 2};
  return {thick, 2 * aim, 1.5 * aim, aim};
}

// What two boxes share when they are the same for a cover.
using BoxKey = std::array<long, 13>;
BoxKey KeyOf(const RoundedBox& box) {
  BoxKey key;
  for (int k = 0; k < 3; ++k) {
    key[k] = std::lround(box.center[k] / kSame);
    key[3 + k] = std::lround(box.half[k] / kSame);
    for (int row = 0; row < 2; ++row)
      key[6 + 2 * k + row] = box.half[k] > 0 ? std::lround(20 * box.axes(row, k)) : 0;
  }
  key[12] = std::lround(box.radius / kSame);
  return key;
}

// Inner points to grow from: the deepest one and points towards all vertices.
std::vector<Vector3d> Seeds(const TriMesh& hull, const Matrix3d& axes, const Vector3d& deepest,
                            const Room& room) {
  const Vector3d middle = axes.transpose() * deepest;
  std::vector<Vector3d> seeds = {middle};
  for (const Vector3d& vertex : hull.vertices) {
    const Vector3d way = axes.transpose() * vertex - middle;
    seeds.push_back(middle + kTowardsVertex * std::min(1.0, room.Walk(middle, way)) * way);
  }
  return seeds;
}

}  // namespace

std::vector<RoundedBox> BoxesInside(const TriMesh& hull, const CoverOptions& options) {
  constexpr int kAllAxes = 7;
  DEX_CHECK_GT(options.extents, 0);
  const ConvexBody body = BodyOf(hull);
  const Vector3d deepest = DeepestPoint(body, MassPropertiesOf(hull).center);
  const double thick = DepthIn(body, deepest) + 0.999 * options.overhang;
  std::vector<RoundedBox> boxes;
  std::set<BoxKey> known;
  for (const Matrix3d& axes : Orientations(hull))
    for (const double radius : Radii(thick, options.radius)) {
      const Room room(body, axes, radius - options.overhang);
      for (const Vector3d& seed : Seeds(hull, axes, deepest, room))
        for (int even = 1; even <= kAllAxes; ++even) {
          if (std::popcount(static_cast<unsigned>(even)) > options.extents) continue;
          const int sides = options.extents == 3 ? kAllAxes : even;
          for (const auto& order : {std::array<int, 3>{0, 1, 2}, std::array<int, 3>{2, 1, 0}}) {
            const RoundedBox box = MakeBox(room.Grow(seed, even, sides, order), axes, radius);
            if (known.insert(KeyOf(box)).second) boxes.push_back(box);
          }
        }
    }
  return boxes;
}

}  // namespace dexremoe
