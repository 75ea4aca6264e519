#include "sim/lanes/hand_cores.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "geometry/hull.h"
#include "sim/lanes/hull_cover.h"

namespace dexremoe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Frame whose first column is the unit vector `direction`.
Matrix3d FrameAlong(const Vector3d& direction) {
  Matrix3d frame;
  frame.col(0) = direction;
  frame.col(1) = direction.unitOrthogonal();
  frame.col(2) = frame.col(0).cross(frame.col(1));
  return frame;
}

RoundedCore CoreFor(const HandModel& hand, int collider) {
  const Collider& source = hand.colliders[collider];
  RoundedCore core;
  core.link = source.link;
  core.collider = collider;
  core.center = source.X_LC.p;
  core.fingertip = source.fingertip;
  return core;
}

RoundedCore BoxCore(RoundedCore core, const Collider& box, double most_radius) {
  core.radius = std::min(box.half_size.minCoeff(), most_radius);
  const Matrix3d R_LC = box.X_LC.q.toRotationMatrix();
  std::array<int, 3> order = {0, 1, 2};
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return box.half_size[a] > box.half_size[b]; });
  for (int k = 0; k < 3; ++k) {
    core.axes.col(k) = R_LC.col(order[k]);
    core.half[k] = box.half_size[order[k]] - core.radius;
  }
  if (core.axes.determinant() < 0) core.axes.col(2) = -core.axes.col(2);
  return core;
}

RoundedCore SimpleCore(const HandModel& hand, int collider, const CoreOptions& options) {
  const Collider& source = hand.colliders[collider];
  RoundedCore core = CoreFor(hand, collider);
  if (source.shape == ColliderShape::kBox) return BoxCore(core, source, options.box_radius);
  core.axes = FrameAlong(source.X_LC.q * Vector3d::UnitZ());
  if (source.shape == ColliderShape::kCapsule) core.half.x() = source.half_length;
  core.radius = source.radius;
  return core;
}

TriMesh HullInLink(const Collider& collider) {
  TriMesh hull = collider.hull;
  for (Vector3d& p : hull.vertices) p = collider.X_LC * p;
  return hull;
}

// Cores for the hulls of a link that are fingertips, or for those that are not.
void AppendHullCores(const HandModel& hand, int link, bool fingertip, const CoverOptions& options,
                     std::vector<RoundedCore>& cores) {
  std::vector<int> colliders;
  ConvexParts hulls;
  for (int i = 0; i < static_cast<int>(hand.colliders.size()); ++i) {
    const Collider& collider = hand.colliders[i];
    if (collider.shape != ColliderShape::kHull || collider.link != link ||
        collider.fingertip != fingertip)
      continue;
    colliders.push_back(i);
    hulls.push_back(HullInLink(collider));
  }
  if (hulls.empty()) return;
  for (const CoverBox& cover : CoverHulls(hulls, options)) {
    RoundedCore core = CoreFor(hand, colliders[cover.hull]);
    core.center = cover.box.center;
    core.axes = cover.box.axes;
    core.half = cover.box.half;
    core.radius = cover.box.radius;
    cores.push_back(core);
  }
}

}  // namespace

std::vector<RoundedCore> CoresOf(const HandModel& hand, const CoreOptions& options) {
  std::vector<RoundedCore> cores;
  for (int link = 0; link < static_cast<int>(hand.links.size()); ++link) {
    for (int i = 0; i < static_cast<int>(hand.colliders.size()); ++i)
      if (hand.colliders[i].link == link && hand.colliders[i].shape != ColliderShape::kHull)
        cores.push_back(SimpleCore(hand, i, options));
    for (const bool fingertip : {false, true})
      AppendHullCores(hand, link, fingertip, fingertip ? options.tip_cover : options.cover, cores);
  }
  return cores;
}

double DistanceTo(const RoundedCore& core, const Vector3d& p_L) {
  return DistanceTo(RoundedBox{core.center, core.axes, core.half, core.radius}, p_L);
}

}  // namespace dexremoe
