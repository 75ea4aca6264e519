#include "sim/ode/gjk.h"

#include <Eigen/Geometry>
#include <cmath>

namespace dexremoe {
namespace {

using Eigen::Vector3d;

constexpr int kMaxIterations = 48;
constexpr double kRelativeGap = 1e-10;  // of the squared distance
constexpr double kTouching2 = 1e-16;    // cores closer than 1e-8 m count as overlapping

// Corner of a simplex in the Minkowski difference a - b, and what it is made of.
struct Corner {
  Vector3d w;  // Vertex(ia) of a - Vertex(ib) of b
  int ia = 0, ib = 0;
};

struct Simplex {
  Corner corner[4];
  double weight[4];
  int size = 0;

  Vector3d Nearest() const {
    Vector3d sum = Vector3d::Zero();
    for (int i = 0; i < size; ++i) sum += weight[i] * corner[i].w;
    return sum;
  }
  bool Has(int ia, int ib) const {
    for (int i = 0; i < size; ++i)
      if (corner[i].ia == ia && corner[i].ib == ib) return true;
    return false;
  }
};

Simplex Keep(const Simplex& from, std::initializer_list<std::pair<int, double>> kept) {
  Simplex simplex;
  for (const auto& [index, weight] : kept) {
    simplex.corner[simplex.size] = from.corner[index];
    simplex.weight[simplex.size++] = weight;
  }
  return simplex;
}

// Each Nearest* returns the smallest sub-simplex that holds the point nearest to the origin.
Simplex NearestOnSegment(const Simplex& s, int i, int j) {
  const Vector3d &a = s.corner[i].w, &b = s.corner[j].w;
  const Vector3d ab = b - a;
  const double along = -a.dot(ab), length2 = ab.squaredNorm();
  if (along <= 0) return Keep(s, {{i, 1.0}});
  if (along >= length2) return Keep(s, {{j, 1.0}});
  const double t = along / length2;
  return Keep(s, {{i, 1 - t}, {j, t}});
}

Simplex NearestOnTriangle(const Simplex& s, int i, int j, int k) {
  const Vector3d &a = s.corner[i].w, &b = s.corner[j].w, &c = s.corner[k].w;
  const Vector3d ab = b - a, ac = c - a;
  const double d1 = -ab.dot(a), d2 = -ac.dot(a);
  if (d1 <= 0 && d2 <= 0) return Keep(s, {{i, 1.0}});
  const double d3 = -ab.dot(b), d4 = -ac.dot(b);
  if (d3 >= 0 && d4 <= d3) return Keep(s, {{j, 1.0}});
  const double d5 = -ab.dot(c), d6 = -ac.dot(c);
  if (d6 >= 0 && d5 <= d6) return Keep(s, {{k, 1.0}});
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return NearestOnSegment(s, i, j);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return NearestOnSegment(s, i, k);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return NearestOnSegment(s, j, k);
  const double sum = va + vb + vc;
  if (sum <= 0) return NearestOnSegment(s, i, j);  // a needle: its long side will do
  return Keep(s, {{i, va / sum}, {j, vb / sum}, {k, vc / sum}});
}

// Whether the origin lies outside the plane of (i, j, k), seen from the fourth corner.
bool OriginBeyond(const Simplex& s, int i, int j, int k, int fourth) {
  const Vector3d& a = s.corner[i].w;
  const Vector3d normal = (s.corner[j].w - a).cross(s.corner[k].w - a);
  const double origin = -normal.dot(a), inside = normal.dot(s.corner[fourth].w - a);
  return origin * inside <= 0;
}

// Size 4 in the result means that the tetrahedron holds the origin.
Simplex NearestOnTetrahedron(const Simplex& s) {
  static constexpr int kFaces[4][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}};
  Simplex best = s;
  double least = INFINITY;
  for (const auto& [i, j, k, fourth] : kFaces) {
    if (!OriginBeyond(s, i, j, k, fourth)) continue;
    const Simplex face = NearestOnTriangle(s, i, j, k);
    const double distance2 = face.Nearest().squaredNorm();
    if (distance2 < least) {
      least = distance2;
      best = face;
    }
  }
  return best;
}

Simplex Reduce(const Simplex& s) {
  switch (s.size) {
    case 1:
      return Keep(s, {{0, 1.0}});
    case 2:
      return NearestOnSegment(s, 0, 1);
    case 3:
      return NearestOnTriangle(s, 0, 1, 2);
    default:
      return NearestOnTetrahedron(s);
  }
}

Corner SupportAgainst(const PlacedShape& a, const PlacedShape& b, const Vector3d& direction) {
  Corner corner;
  corner.ia = a.SupportIndex(-direction);
  corner.ib = b.SupportIndex(direction);
  corner.w = a.Vertex(corner.ia) - b.Vertex(corner.ib);
  return corner;
}

Proximity ResultOf(const Simplex& simplex, const Vector3d& nearest, const PlacedShape& a,
                   const PlacedShape& b) {
  Proximity result;
  result.near = true;
  result.distance = nearest.norm();
  result.normal = nearest / result.distance;
  result.on_a.setZero();
  result.on_b.setZero();
  for (int i = 0; i < simplex.size; ++i) {
    result.on_a += simplex.weight[i] * a.Vertex(simplex.corner[i].ia);
    result.on_b += simplex.weight[i] * b.Vertex(simplex.corner[i].ib);
  }
  return result;
}

// Cores that touch so exactly that portal refinement sees them apart.
Proximity Touching(const Vector3d& direction, const PlacedShape& a) {
  Proximity result;
  result.near = true;
  result.normal = direction.normalized();
  result.on_a = a.Vertex(a.SupportIndex(-direction));
  result.on_b = result.on_a;
  return result;
}

}  // namespace

Proximity FindProximity(const PlacedShape& a, const PlacedShape& b, double max_distance) {
  Simplex simplex;
  Vector3d nearest = a.Place(a.shape->center) - b.Place(b.shape->center);
  if (nearest.squaredNorm() < kTouching2) nearest = Vector3d::UnitX();
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const Corner corner = SupportAgainst(a, b, nearest);
    // All of a - b lies beyond the plane through w: a lower bound of the distance.
    const double along = corner.w.dot(nearest), length2 = nearest.squaredNorm();
    if (along > 0 && along * along > max_distance * max_distance * length2) return {};
    if (simplex.size > 0) {
      const bool done = length2 - along <= kRelativeGap * length2;
      if (done || simplex.Has(corner.ia, corner.ib)) return ResultOf(simplex, nearest, a, b);
    }
    simplex.corner[simplex.size++] = corner;
    simplex = Reduce(simplex);
    const Vector3d previous = nearest;
    nearest = simplex.Nearest();
    if (simplex.size < 4 && nearest.squaredNorm() >= kTouching2) continue;
    const Proximity overlap = FindPenetration(a, b);
    return overlap.near ? overlap : Touching(previous, a);
  }
  return ResultOf(simplex, nearest, a, b);
}

}  // namespace dexremoe
