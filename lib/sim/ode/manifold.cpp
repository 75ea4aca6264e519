#include "sim/ode/manifold.h"

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

namespace dexremoe {
namespace {

using Eigen::Vector3d;

constexpr double kParallelSine = 0.087;  // five degrees
constexpr double kParallelCosine = 0.9962;
constexpr double kShortest = 1e-4;  // m; nearer points are one point
constexpr int kMaxCorners = 64;

// What a shape turns towards the other one: a corner (1 point), an edge (2) or a face (more).
struct Feature {
  std::array<Vector3d, kMaxCorners> corner;
  int size = 0;
  Vector3d plane;  // outward normal, faces only
};

void Add(Feature& feature, const Vector3d& corner) {
  if (feature.size < kMaxCorners) feature.corner[feature.size++] = corner;
}

const ConvexFace* FaceAlong(const ConvexShape& shape, const Vector3d& direction) {
  const ConvexFace* best = nullptr;
  double most = kParallelCosine;
  for (const ConvexFace& face : shape.faces) {
    const double along = face.normal.dot(direction);
    if (along >= most) {
      most = along;
      best = &face;
    }
  }
  return best;
}

// The edge at the corner that lies flattest across direction, if within five degrees.
const std::array<int, 2>* EdgeAcross(const ConvexShape& shape, int corner,
                                     const Vector3d& direction) {
  const std::array<int, 2>* best = nullptr;
  double least = kParallelSine;
  for (const auto& edge : shape.edges) {
    if (edge[0] != corner && edge[1] != corner) continue;
    const Vector3d along = shape.Vertex(edge[1]) - shape.Vertex(edge[0]);
    const double slope = std::abs(along.dot(direction)) / along.norm();
    if (slope <= least) {
      least = slope;
      best = &edge;
    }
  }
  return best;
}

Feature FeatureAlong(const PlacedShape& placed, const Vector3d& direction) {
  const ConvexShape& shape = *placed.shape;
  const Vector3d local = placed.ToLocalDirection(direction);
  Feature feature;
  if (const ConvexFace* face = FaceAlong(shape, local)) {
    for (const int i : face->loop) Add(feature, placed.Vertex(i));
    feature.plane = placed.ToCommonDirection(face->normal);
    return feature;
  }
  const int corner = shape.Support(local);
  if (shape.size() == 2) {
    const Vector3d axis = (shape.Vertex(1) - shape.Vertex(0)).normalized();
    if (std::abs(axis.dot(local)) <= kParallelSine) {
      Add(feature, placed.Vertex(0));
      Add(feature, placed.Vertex(1));
      return feature;
    }
  } else if (const auto* edge = EdgeAcross(shape, corner, local)) {
    Add(feature, placed.Vertex((*edge)[0]));
    Add(feature, placed.Vertex((*edge)[1]));
    return feature;
  }
  Add(feature, placed.Vertex(corner));
  return feature;
}

// The part of `subject` where side . (x - on) <= 0 (Sutherland, Hodgman 1974).
Feature ClipByPlane(const Feature& subject, const Vector3d& side, const Vector3d& on) {
  Feature clipped;
  const int steps = subject.size == 2 ? 1 : subject.size;
  for (int i = 0; i < steps; ++i) {
    const Vector3d &from = subject.corner[i], &to = subject.corner[(i + 1) % subject.size];
    const double height_from = side.dot(from - on), height_to = side.dot(to - on);
    if (height_from <= 0) Add(clipped, from);
    if ((height_from < 0 && height_to > 0) || (height_from > 0 && height_to < 0))
      Add(clipped, from + height_from / (height_from - height_to) * (to - from));
    if (subject.size == 2 && height_to <= 0) Add(clipped, to);
  }
  return clipped;
}

Feature ClipByFace(Feature subject, const Feature& face, const Vector3d& normal) {
  for (int i = 0; i < face.size && subject.size > 0; ++i) {
    const Vector3d& from = face.corner[i];
    const Vector3d side = (face.corner[(i + 1) % face.size] - from).cross(normal);
    subject = ClipByPlane(subject, side, from);
  }
  return subject;
}

// The four points that matter: the deepest, the one farthest from it, and the ones farthest from
// the line through those two on either side.
void KeepFour(std::vector<ManifoldPoint>& points, const Vector3d& normal) {
  if (points.size() <= 4) return;
  const auto take = [&](auto score) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < points.size(); ++i)
      if (score(points[i]) > score(points[best])) best = i;
    return points[best];
  };
  const ManifoldPoint first = take([](const ManifoldPoint& p) { return -p.gap; });
  const ManifoldPoint second =
      take([&](const ManifoldPoint& p) { return (p.position - first.position).squaredNorm(); });
  const Vector3d across = normal.cross(second.position - first.position);
  const auto offset = [&](const ManifoldPoint& p) {
    return across.dot(p.position - first.position);
  };
  const ManifoldPoint third = take(offset);
  const ManifoldPoint fourth = take([&](const ManifoldPoint& p) { return -offset(p); });
  points = {first, second, third, fourth};
}

class Builder {
 public:
  Builder(const PlacedShape& a, const PlacedShape& b, const Proximity& nearest, double margin)
      : radius_a_(a.shape->radius * a.scale),
        radius_b_(b.shape->radius * b.scale),
        margin_(margin),
        nearest_(nearest),
        normal_(nearest.normal) {
    const Feature of_a = FeatureAlong(a, -normal_), of_b = FeatureAlong(b, normal_);
    if (of_a.size == 2 && of_b.size == 2) {
      ClipEdges(of_a, of_b);
    } else if (of_a.size > 2 && of_b.size > 1) {
      ClipOnA(of_a, of_b);
    } else if (of_b.size > 2 && of_a.size > 1) {
      ClipOnB(of_a, of_b);
    }
    if (points_.empty()) AddPoint(nearest_.on_a, nearest_.on_b);
  }

  Manifold Take() {
    KeepFour(points_, normal_);
    Manifold manifold;
    manifold.normal = normal_;
    for (const ManifoldPoint& point : points_) manifold.point[manifold.size++] = point;
    return manifold;
  }

 private:
  void AddPoint(const Vector3d& on_a, const Vector3d& on_b) {
    ManifoldPoint point;
    point.gap = (on_a - on_b).dot(normal_) - radius_a_ - radius_b_;
    point.position = 0.5 * (on_a + on_b + (radius_b_ - radius_a_) * normal_);
    if (point.gap > margin_) return;
    for (const ManifoldPoint& other : points_)
      if ((other.position - point.position).squaredNorm() < kShortest * kShortest) return;
    points_.push_back(point);
  }

  // b's feature against a face of a: a's plane is met along the normal.
  void ClipOnA(const Feature& of_a, const Feature& of_b) {
    const Feature clipped = ClipByFace(of_b, of_a, of_a.plane);
    for (int i = 0; i < clipped.size; ++i) {
      const Vector3d& on_b = clipped.corner[i];
      const double up = of_a.plane.dot(of_a.corner[0] - on_b) / of_a.plane.dot(normal_);
      AddPoint(on_b + up * normal_, on_b);
    }
  }

  void ClipOnB(const Feature& of_a, const Feature& of_b) {
    const Feature clipped = ClipByFace(of_a, of_b, of_b.plane);
    for (int i = 0; i < clipped.size; ++i) {
      const Vector3d& on_a = clipped.corner[i];
      const double up = of_b.plane.dot(on_a - of_b.corner[0]) / of_b.plane.dot(normal_);
      AddPoint(on_a, on_a - up * normal_);
    }
  }

  // Two nearly parallel edges touch along their overlap; others in the nearest point only.
  void ClipEdges(const Feature& of_a, const Feature& of_b) {
    const Vector3d along_a = of_a.corner[1] - of_a.corner[0];
    const Vector3d along_b = of_b.corner[1] - of_b.corner[0];
    const double length_a = along_a.norm(), length_b = along_b.norm();
    if (along_a.cross(along_b).norm() > kParallelSine * length_a * length_b) return;
    const Vector3d axis = along_a / length_a;
    const double slope = axis.dot(along_b);
    double from = axis.dot(of_b.corner[0] - of_a.corner[0]), to = from + slope;
    const double start = from;
    if (from > to) std::swap(from, to);
    from = std::max(from, 0.0);
    to = std::min(to, length_a);
    if (to < from) return;
    for (const double s : {from, to})
      AddPoint(of_a.corner[0] + s * axis, of_b.corner[0] + (s - start) / slope * along_b);
  }

  double radius_a_, radius_b_, margin_;
  const Proximity& nearest_;
  Vector3d normal_;
  std::vector<ManifoldPoint> points_;
};

}  // namespace

Manifold FindManifold(const PlacedShape& a, const PlacedShape& b, double margin) {
  const double rounding = a.shape->radius * a.scale + b.shape->radius * b.scale;
  const Proximity nearest = FindProximity(a, b, rounding + margin);
  if (!nearest.near) return {};
  return Builder(a, b, nearest, margin).Take();
}

}  // namespace dexremoe
