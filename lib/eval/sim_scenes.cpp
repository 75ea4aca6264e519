#include "eval/sim_scenes.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/random.h"
#include "geometry/hull.h"

namespace dexremoe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

TriMesh HullPart(const std::vector<Vector3d>& points) {
  const auto hull = ConvexHull(points);
  DEX_CHECK(hull.has_value());
  return *hull;
}

TriMesh BoxPart(const Vector3d& size, const Vector3d& center = Vector3d::Zero()) {
  std::vector<Vector3d> corners;
  for (int c = 0; c < 8; ++c)
    corners.push_back(
        center + 0.5 * size.cwiseProduct(Vector3d(c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 1 : -1)));
  return HullPart(corners);
}

// Inertia of a point of unit mass at r.
Matrix3d PointInertia(const Vector3d& r) {
  return r.squaredNorm() * Matrix3d::Identity() - r * r.transpose();
}

// The sector between two angles of an upright octagonal tube (radii to the corners), z from low to
// high. An inner radius of 0 makes it a wedge.
TriMesh TubeSector(double inner, double outer, int sector, double low, double high) {
  std::vector<Vector3d> points;
  for (const int corner : {sector, sector + 1}) {
    const double angle = corner * M_PI / 4;
    for (const double radius : {inner, outer})
      for (const double z : {low, high})
        points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  return HullPart(points);
}

SimObject Airplane() {
  const double y = 0.008;  // half the fuselage's width: wings begin there
  ConvexParts parts = {BoxPart({0.085, 0.016, 0.016}),
                       BoxPart({0.014, 0.006, 0.020}, {-0.034, 0, 0.018})};
  for (const double side : {-1.0, 1.0}) {
    parts.push_back(BoxPart({0.026, 0.032, 0.006}, {0.006, side * (y + 0.016), 0}));
    parts.push_back(BoxPart({0.014, 0.014, 0.006}, {-0.034, side * (y + 0.007), 0}));
  }
  return CompoundObject("airplane", std::move(parts));
}

SimObject Mug() {
  constexpr double kInner = 0.020, kOuter = 0.026, kHalf = 0.024, kFloor = 0.006;
  ConvexParts parts;
  std::vector<Vector3d> floor;
  for (int s = 0; s < 8; ++s) {
    parts.push_back(TubeSector(kInner, kOuter, s, -kHalf, kHalf));
    for (const double z : {-kHalf, -kHalf + kFloor})
      floor.emplace_back(kInner * std::cos(s * M_PI / 4), kInner * std::sin(s * M_PI / 4), z);
  }
  parts.push_back(HullPart(floor));
  for (const double z : {-0.014, 0.014})
    parts.push_back(BoxPart({0.012, 0.008, 0.007}, {0.032, 0, z}));
  parts.push_back(BoxPart({0.007, 0.008, 0.035}, {0.0415, 0, 0}));
  return CompoundObject("mug", std::move(parts));
}

SimObject LShape() {
  return CompoundObject("L", {BoxPart({0.030, 0.060, 0.045}, {-0.010, 0, 0}),
                              BoxPart({0.030, 0.030, 0.045}, {0.020, -0.015, 0})});
}

Vector3d DrawSize(Rng& rng, double low, double high) {
  Vector3d size;
  for (double& x : size) x = rng.Uniform(low, high);
  return size;
}

// A box, or the hull of points on an ellipsoid.
TriMesh DrawPart(Rng& rng, const Vector3d& size, const Vector3d& center) {
  if (rng.Uniform() < 0.5) return BoxPart(size, center);
  std::vector<Vector3d> points;
  for (int i = 0; i < 16; ++i) {
    const Vector3d direction(rng.Normal(), rng.Normal(), rng.Normal());
    points.push_back(center + 0.6 * size.cwiseProduct(direction.normalized()));
  }
  return HullPart(points);
}

SimObject DrawCompound(const std::string& name, Rng& rng) {
  const Vector3d core = DrawSize(rng, 0.032, 0.048);
  ConvexParts parts = {DrawPart(rng, core, Vector3d::Zero())};
  const int limbs = 1 + static_cast<int>(rng.Index(5));
  for (int i = 0; i < limbs; ++i) {
    Vector3d center = DrawSize(rng, -0.3, 0.3).cwiseProduct(core);
    const auto axis = rng.Index(3);
    center[axis] = (rng.Uniform() < 0.5 ? -0.5 : 0.5) * core[axis];
    parts.push_back(DrawPart(rng, DrawSize(rng, 0.010, 0.026), center));
  }
  return CompoundObject(name, std::move(parts));
}

}  // namespace

SimObject CompoundObject(const std::string& name, ConvexParts parts) {
  double volume = 0;
  Vector3d center = Vector3d::Zero();
  for (const TriMesh& part : parts) {
    const MassProperties mass = MassPropertiesOf(part);
    volume += mass.volume;
    center += mass.volume * mass.center;
  }
  DEX_CHECK_GT(volume, 0);
  center /= volume;
  SimObject object;
  object.name = name;
  object.unit_inertia.setZero();
  for (TriMesh& part : parts) {
    for (Vector3d& p : part.vertices) {
      p -= center;
      object.radius = std::max(object.radius, p.norm());
    }
    const MassProperties mass = MassPropertiesOf(part);
    object.unit_inertia += (mass.inertia + mass.volume * PointInertia(mass.center)) / volume;
  }
  object.parts = std::move(parts);
  return object;
}

SimObject BoxObject(const std::string& name, const Vector3d& size) {
  return CompoundObject(name, {BoxPart(size)});
}

std::vector<SimObject> ValidationShapes() {
  return {BoxObject("cube", Vector3d::Constant(0.055)), LShape(), Airplane(), Mug()};
}

std::vector<SimObject> RandomCompounds(int count, std::uint64_t seed) {
  std::vector<SimObject> objects;
  for (int i = 0; i < count; ++i) {
    Rng rng(seed, Stream::kRecipe, {static_cast<std::uint64_t>(i)});
    objects.push_back(DrawCompound(fmt::format("compound_{}", i), rng));
  }
  return objects;
}

HandModel BoardHand() {
  HandModel hand;
  hand.name = "board";
  hand.source = "board";
  hand.links.resize(1);
  hand.links[0].name = "base";
  Collider board;
  board.name = "board";
  board.shape = ColliderShape::kBox;
  board.half_size = {0.3, 0.3, 0.02};
  board.X_LC.p = {0, 0, -0.02};
  hand.colliders = {board};
  hand.kp = HandOptions().kp;
  hand.kd = HandOptions().kd;
  return hand;
}

}  // namespace dexremoe
