// Overlapping cores: Minkowski portal refinement (Snethen, "XenoCollide", 2008) through libccd
// gives a direction near the least penetration; the faces of both shapes then make it exact where
// the contact is a face contact.
#include <ccd/ccd.h>

#include <Eigen/Geometry>

#include "sim/ode/gjk.h"

namespace dexremoe {
namespace {

using Eigen::Vector3d;

constexpr double kTouchingDepth = 1e-9;  // m

void CcdSupport(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* vertex) {
  const auto& placed = *static_cast<const PlacedShape*>(object);
  const Vector3d d(direction->v[0], direction->v[1], direction->v[2]);
  const Vector3d support = placed.Vertex(placed.SupportIndex(d));
  ccdVec3Set(vertex, support.x(), support.y(), support.z());
}

void CcdCenter(const void* object, ccd_vec3_t* center) {
  const auto& placed = *static_cast<const PlacedShape*>(object);
  const Vector3d c = placed.Place(placed.shape->center);
  ccdVec3Set(center, c.x(), c.y(), c.z());
}

// Outward normal of the face most along direction, in the common frame; false without faces.
bool FaceNormalAlong(const PlacedShape& placed, const Vector3d& direction, Vector3d& normal) {
  const Vector3d local = placed.ToLocalDirection(direction);
  const ConvexFace* best = nullptr;
  double most = -2;
  for (const ConvexFace& face : placed.shape->faces) {
    const double along = face.normal.dot(local);
    if (along > most) {
      most = along;
      best = &face;
    }
  }
  if (best == nullptr) return false;
  normal = placed.ToCommonDirection(best->normal);
  return true;
}

// Takes `normal` instead when moving a along it frees the cores sooner.
void Improve(const PlacedShape& a, const PlacedShape& b, const Vector3d& normal, bool face_of_b,
             Proximity& best) {
  const Vector3d on_a = a.Vertex(a.SupportIndex(-normal));
  const Vector3d on_b = b.Vertex(b.SupportIndex(normal));
  const double distance = (on_a - on_b).dot(normal);
  if (distance <= best.distance) return;
  best.distance = distance;
  best.normal = normal;
  best.on_a = face_of_b ? on_a : on_b + distance * normal;
  best.on_b = face_of_b ? on_a - distance * normal : on_b;
}

}  // namespace

Proximity FindPenetration(const PlacedShape& a, const PlacedShape& b) {
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.support1 = ccd.support2 = CcdSupport;
  ccd.center1 = ccd.center2 = CcdCenter;
  ccd.mpr_tolerance = 1e-6;
  ccd.max_iterations = 64;
  ccd_real_t depth;
  ccd_vec3_t direction, position;
  Proximity best;
  // The result moves the second shape out of the first.
  if (ccdMPRPenetration(&b, &a, &ccd, &depth, &direction, &position) != 0) return best;
  Vector3d normal(direction.v[0], direction.v[1], direction.v[2]);
  if (normal.squaredNorm() < 0.25) normal = (a.Place(a.shape->center) - b.Place(b.shape->center));
  if (normal.squaredNorm() == 0) normal = Vector3d::UnitZ();
  normal.normalize();
  const Vector3d middle(position.v[0], position.v[1], position.v[2]);
  best.near = true;
  best.distance = -std::max(depth, kTouchingDepth);
  best.normal = normal;
  best.on_a = middle + 0.5 * best.distance * normal;
  best.on_b = middle - 0.5 * best.distance * normal;
  for (int round = 0; round < 2; ++round) {
    Vector3d face;
    const Vector3d from = best.normal;
    if (FaceNormalAlong(b, from, face)) Improve(a, b, face, true, best);
    if (FaceNormalAlong(a, -from, face)) Improve(a, b, -face, false, best);
  }
  return best;
}

}  // namespace dexremoe
