// Distance and penetration of two placed convex cores.
#pragma once

#include <Eigen/Core>

#include "sim/ode/convex.h"

namespace dexremoe {

// The nearest points of two cores. The normal points from b to a.
struct Proximity {
  bool near = false;       // false: farther apart than asked for; nothing else is set
  double distance = 0;     // of the cores along normal; negative when they overlap; m
  Eigen::Vector3d normal;  // unit, from b to a
  Eigen::Vector3d on_a, on_b;
};

// Distance of the cores of a and b if it is at most max_distance (Gilbert, Johnson, Keerthi 1988,
// with the sub-distance tests of Ericson, "Real-Time Collision Detection", chapters 5 and 9). When
// the cores overlap the direction of least penetration is found by portal refinement (libccd) and
// improved over the faces of both.
Proximity FindProximity(const PlacedShape& a, const PlacedShape& b, double max_distance);

// Penetration of overlapping cores only; `near` is false when they turn out to be apart.
Proximity FindPenetration(const PlacedShape& a, const PlacedShape& b);

}  // namespace dexremoe
