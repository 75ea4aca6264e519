// Hand colliders as rounded cores, the shapes that the lanes engine collides with a distance field.
#pragma once

#include <vector>

#include "hand/hand_model.h"
#include "sim/lanes/hull_cover.h"

namespace dexremoe {

// A box core swept by a sphere: all points within `radius` of the core. Spheres have half = 0,
// capsules one extent above zero, rounded plates two, rounded boxes three.
struct RoundedCore {
  int link = 0;                                        // of HandModel::links
  int collider = 0;                                    // of HandModel::colliders
  Eigen::Vector3d center = Eigen::Vector3d::Zero();    // of the core in L; m
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // columns: directions of the extents in L
  Eigen::Vector3d half = Eigen::Vector3d::Zero();      // half extents, descending, >= 0; m
  double radius = 0;                                   // m
  bool fingertip = false;                              // as the collider's
};

struct CoreOptions {
  double box_radius = 8e-3;  // rounding of a box's edges, at most; m
  CoverOptions cover;        // of the hulls of a link
  // Of a link's fingertip hulls: capsules, for which finger against finger is cheap.
  CoverOptions tip_cover = {.most = 5, .extents = 1};
};

// The cores of a hand, link by link:
//   sphere, capsule: exactly themselves;
//   box:   the box shrunk by r = min(smallest half extent, box_radius) and rounded by r: faces are
//          exact, edges lose (sqrt(2) - 1) r, corners (sqrt(3) - 1) r;
//   hulls: the hulls of a link are covered together by few rounded boxes (CoverHulls), fingertip
//          hulls apart from others and by capsules. `collider` is then the hull that holds the box.
std::vector<RoundedCore> CoresOf(const HandModel& hand, const CoreOptions& options = {});

// Distance of p_L from the surface of the core; negative inside; m.
double DistanceTo(const RoundedCore& core, const Eigen::Vector3d& p_L);

}  // namespace dexremoe
