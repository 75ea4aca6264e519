#include "geometry/recipe_shapes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

namespace dexremoe {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Field MakeSphere(RecipeArgs& args) {
  const double r = args.Positive("r");
  return [r](const Vector3d& p) { return p.norm() - r; };
}

// First-order distance (exact on the surface).
Field MakeEllipsoid(RecipeArgs& args) {
  const Vector3d r = args.Spread("r");
  if (!(r.minCoeff() > 0)) args.place().Fail("r: expected radii above 0, found {}", r.minCoeff());
  return [r](const Vector3d& p) {
    const double level = p.cwiseQuotient(r).norm();
    const double slope = p.cwiseQuotient(r.cwiseProduct(r)).norm();
    if (slope < 1e-9 || level < 0.2) return (level - 1) * r.minCoeff();
    return level * (level - 1) / slope;
  };
}

Field MakeBox(RecipeArgs& args) {
  const Vector3d half = args.Spread("size") / 2;
  const double round = args.Number("round", 0);
  if (!(half.minCoeff() > 0) || round < 0 || round > half.minCoeff())
    args.place().Fail(
        "box: expected sizes above 0 and round of at most half the smallest, found {}", round);
  return [half, round](const Vector3d& p) {
    const Vector3d q = p.cwiseAbs() - half + Vector3d::Constant(round);
    return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0) - round;
  };
}

// Two balls and the cone that touches both (Quilez, round cone).
Field MakeCapsule(RecipeArgs& args) {
  const Vector3d from = args.Vector("from"), axis = args.Vector("to") - from;
  const Vector2d r = args.Pair("r");
  const double length = axis.norm(), drop = r[0] - r[1];
  if (!(r.minCoeff() > 0)) args.place().Fail("r: expected radii above 0, found {}", r.minCoeff());
  if (length <= std::abs(drop)) {
    const Vector3d at = drop > 0 ? from : Vector3d(from + axis);
    const double radius = r.maxCoeff();
    return [at, radius](const Vector3d& p) { return (p - at).norm() - radius; };
  }
  const double sine = drop / length, cosine = std::sqrt(1 - sine * sine);
  return [=, unit = Vector3d(axis / length)](const Vector3d& p) {
    const double along = (p - from).dot(unit);
    const double aside = std::sqrt(std::max((p - from).squaredNorm() - along * along, 0.0));
    const double foot = along * cosine - aside * sine;  // place along the cone's side
    if (foot < 0) return (p - from).norm() - r[0];
    if (foot > length * cosine) return (p - from - axis).norm() - r[1];
    return aside * cosine + along * sine - r[0];
  };
}

// A cylinder or a blunt cone with flat ends (Quilez, capped cone).
Field MakeCylinder(RecipeArgs& args) {
  const Vector3d from = args.Vector("from"), axis = args.Vector("to") - from;
  const double round = args.Number("round", 0), length = axis.norm();
  const Vector2d r = args.Pair("r");
  if (!(length > 2 * round) || round < 0 || !(r.minCoeff() >= round) || !(r.maxCoeff() > 0))
    args.place().Fail("cylinder: expected length and radii above 'round', found round={}", round);
  const double half = length / 2 - round;
  const Vector2d core = r - Vector2d::Constant(round);
  return
      [=, unit = Vector3d(axis / length), middle = Vector3d(from + axis / 2)](const Vector3d& p) {
        const double y = (p - middle).dot(unit);
        const Vector2d q(std::sqrt(std::max((p - middle).squaredNorm() - y * y, 0.0)), y);
        const Vector2d top(core[1], half), side(core[1] - core[0], 2 * half);
        const Vector2d cap(q.x() - std::min(q.x(), y < 0 ? core[0] : core[1]), std::abs(y) - half);
        const double t = std::clamp((top - q).dot(side) / side.squaredNorm(), 0.0, 1.0);
        const Vector2d flank = q - top + t * side;
        const bool inside = flank.x() < 0 && cap.y() < 0;
        const double distance = std::sqrt(std::min(cap.squaredNorm(), flank.squaredNorm()));
        return (inside ? -distance : distance) - round;
      };
}

Field MakeTorus(RecipeArgs& args) {
  const Vector2d r = args.Pair("r");
  if (!(r[1] > 0) || !(r[0] > 0)) args.place().Fail("r: expected (ring, tube) above 0");
  return
      [r](const Vector3d& p) { return Vector2d(p.head<2>().norm() - r[0], p.z()).norm() - r[1]; };
}

Field MakePlane(RecipeArgs& args) {
  const Vector3d normal = args.Vector("normal");
  if (!(normal.norm() > 0)) args.place().Fail("normal: expected a direction, found (0, 0, 0)");
  return [n = Vector3d(normal.normalized())](const Vector3d& p) { return n.dot(p); };
}

}  // namespace

double SmoothMin(double a, double b, double k) {
  if (!(k > 0)) return std::min(a, b);
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - h * h * k / 4;
}

double SuperellipseDistance(double u, double v, double a, double b, double n) {
  const double pu = std::pow(std::abs(u) / a, n), pv = std::pow(std::abs(v) / b, n);
  const double level = std::pow(pu + pv, 1 / n);
  const double least = std::min(a, b);
  if (level < 0.3) return (level - 1) * least;
  // Gradient of the level; the distance is at most what its slope at the surface says.
  const double gu = u != 0 ? pu / std::abs(u) : 0, gv = v != 0 ? pv / std::abs(v) : 0;
  const double slope = std::pow(level, 1 - n) * std::hypot(gu, gv);
  return slope > 0 ? (level - 1) / slope : (level - 1) * least;
}

Field MakeShape(const std::string& name, RecipeArgs& args) {
  using Maker = Field (*)(RecipeArgs&);
  static const std::map<std::string, Maker> kMakers = {
      {"sphere", MakeSphere},   {"ellipsoid", MakeEllipsoid}, {"box", MakeBox},
      {"capsule", MakeCapsule}, {"cylinder", MakeCylinder},   {"torus", MakeTorus},
      {"plane", MakePlane},     {"tube", MakeTube},           {"loft", MakeLoft},
      {"wing", MakeWing},       {"extrude", MakeExtrusion}};
  const auto found = kMakers.find(name);
  if (found != kMakers.end()) return found->second(args);
  std::string names;
  for (const auto& entry : kMakers) names += (names.empty() ? "" : ", ") + entry.first;
  args.place().Fail("expected a shape ({}), found '{}'", names, name);
}

}  // namespace dexremoe
