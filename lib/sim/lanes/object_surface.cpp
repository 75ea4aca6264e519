#include "sim/lanes/object_surface.h"

#include <algorithm>
#include <utility>

#include "base/error.h"

namespace dexremoe {
namespace {

using Eigen::Vector3d;
using Polygon = std::vector<Vector3d>;  // planar, convex

constexpr double kLeastArea = 1e-12;  // m^2; smaller triangles and pieces are dropped

Vector3d AreaVector(const Polygon& polygon) {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 2; i < polygon.size(); ++i)
    sum += (polygon[i - 1] - polygon[0]).cross(polygon[i] - polygon[0]) / 2;
  return sum;
}

double Height(const FacePlane& plane, const Vector3d& p) {
  return plane.normal.dot(p) - plane.offset;
}

// Cuts a polygon in two: what is above the plane and what is below it (Sutherland and Hodgman
// 1974).
void Split(const Polygon& polygon, const FacePlane& plane, Polygon& above, Polygon& below) {
  above.clear();
  below.clear();
  Vector3d last = polygon.back();
  double last_height = Height(plane, last);
  for (const Vector3d& p : polygon) {
    const double height = Height(plane, p);
    if ((height > 0) != (last_height > 0)) {
      const Vector3d cut = last + last_height / (last_height - height) * (p - last);
      above.push_back(cut);
      below.push_back(cut);
    }
    (height > 0 ? above : below).push_back(p);
    last = p;
    last_height = height;
  }
}

bool Apart(const Box3& a, const Box3& b) {
  return (a.min.array() > b.max.array()).any() || (b.min.array() > a.max.array()).any();
}

bool OutsideOnePlane(const Polygon& polygon, const ConvexBody& body) {
  const auto outside = [&](const FacePlane& plane) {
    return std::all_of(polygon.begin(), polygon.end(),
                       [&](const Vector3d& p) { return Height(plane, p) > 0; });
  };
  return std::any_of(body.planes.begin(), body.planes.end(), outside);
}

// Appends the pieces of `polygon` outside `body`: plane by plane what is above goes out, what is
// below goes on. A polygon that the body does not touch stays in one piece.
void Subtract(const Polygon& polygon, const ConvexBody& body, std::vector<Polygon>& pieces) {
  Box3 box;
  for (const Vector3d& p : polygon) box.Extend(p);
  if (Apart(box, body.box) || OutsideOnePlane(polygon, body)) {
    pieces.push_back(polygon);
    return;
  }
  const std::size_t start = pieces.size();
  Polygon rest = polygon, above, below;
  for (const FacePlane& plane : body.planes) {
    Split(rest, plane, above, below);
    if (below.size() < 3 || AreaVector(below).norm() < kLeastArea) {
      pieces.resize(start);
      pieces.push_back(polygon);
      return;
    }
    if (above.size() >= 3 && AreaVector(above).norm() >= kLeastArea) pieces.push_back(above);
    std::swap(rest, below);
  }
}

void AppendPolygon(const Polygon& polygon, const Vector3d& shift, TriMesh& mesh) {
  const int first = static_cast<int>(mesh.vertices.size());
  for (const Vector3d& p : polygon) mesh.vertices.push_back(p + shift);
  for (int i = 2; i < static_cast<int>(polygon.size()); ++i)
    mesh.triangles.push_back({first, first + i - 1, first + i});
}

TriMesh Joined(const ConvexParts& parts) {
  TriMesh mesh;
  for (const TriMesh& part : parts) {
    const int first = static_cast<int>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
    for (const auto& [a, b, c] : part.triangles)
      mesh.triangles.push_back({first + a, first + b, first + c});
  }
  return mesh;
}

}  // namespace

ConvexBody BodyOf(const TriMesh& part) {
  // Triangles of one flat face differ by rounding only.
  constexpr double kSameNormal = 1e-9, kSameOffset = 1e-9;
  ConvexBody body;
  body.box = BoundsOf(part);
  for (const auto& [a, b, c] : part.triangles) {
    const Vector3d area = AreaVector({part.vertices[a], part.vertices[b], part.vertices[c]});
    if (area.norm() < kLeastArea) continue;
    const Vector3d normal = area.normalized();
    const double offset = normal.dot(part.vertices[a]);
    const auto same = [&](const FacePlane& plane) {
      return (plane.normal - normal).norm() < kSameNormal &&
             std::abs(plane.offset - offset) < kSameOffset;
    };
    if (std::none_of(body.planes.begin(), body.planes.end(), same))
      body.planes.push_back({normal, offset});
  }
  Vector3d middle = Vector3d::Zero();
  for (const Vector3d& p : part.vertices) middle += p / static_cast<double>(part.vertices.size());
  const auto beyond = [&](const FacePlane& plane) { return Height(plane, middle) >= 0; };
  const auto wrong = std::count_if(body.planes.begin(), body.planes.end(), beyond);
  if (body.planes.size() < 4 || wrong > 0)
    Fail("convex part: expected a body with outward faces, found {} of {} face planes inside out",
         wrong, body.planes.size());
  return body;
}

TriMesh UnionSurface(const ConvexParts& parts) {
  std::vector<ConvexBody> bodies;
  for (const TriMesh& part : parts) bodies.push_back(BodyOf(part));
  TriMesh surface;
  std::vector<Polygon> pieces, next;
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (const auto& [a, b, c] : parts[i].triangles) {
      Polygon triangle = {parts[i].vertices[a], parts[i].vertices[b], parts[i].vertices[c]};
      const Vector3d area = AreaVector(triangle);
      if (area.norm() < kLeastArea) continue;
      const Vector3d front = kSeam * area.normalized();
      for (Vector3d& p : triangle) p += front;
      pieces = {std::move(triangle)};
      for (std::size_t k = 0; k < parts.size() && !pieces.empty(); ++k) {
        if (k == i) continue;
        next.clear();
        for (const Polygon& piece : pieces) Subtract(piece, bodies[k], next);
        std::swap(pieces, next);
      }
      for (const Polygon& piece : pieces) AppendPolygon(piece, -front, surface);
    }
  return surface;
}

UnionDistance::UnionDistance(const ConvexParts& parts)
    : faces_{TriangleBvh(Joined(parts))}, surface_{TriangleBvh(UnionSurface(parts))} {
  for (const TriMesh& part : parts) bodies_.push_back(BodyOf(part));
}

double UnionDistance::Nearest::Distance(const Vector3d& p) {
  const SurfacePoint nearest = tree.Closest(p, hint);
  hint = nearest.triangle;
  return nearest.distance;
}

bool UnionDistance::Inside(const Vector3d& p) const {
  const auto holds = [&](const ConvexBody& body) {
    return std::all_of(body.planes.begin(), body.planes.end(),
                       [&](const FacePlane& plane) { return Height(plane, p) <= 0; });
  };
  return std::any_of(bodies_.begin(), bodies_.end(), holds);
}

double UnionDistance::Signed(const Vector3d& p, bool inside) {
  if (inside) return -surface_.Distance(p);
  const double distance = faces_.Distance(p);
  if (distance >= kSeam) return distance;
  // In a narrow gap the union's surface is far away.
  const double depth = surface_.Distance(p);
  return depth > distance + kSeam ? -depth : distance;
}

}  // namespace dexremoe
