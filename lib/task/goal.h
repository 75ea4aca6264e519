// Goal orientations.
#pragma once

#include <Eigen/Geometry>

#include "base/random.h"

namespace dexremoe {

// A goal q_WG. With max_angle >= pi it is Haar-uniform on SO(3) (paper, section IV-A). Otherwise it
// lies between min_angle and max_angle (rad) from q_WO: axis uniform, angle distributed as under
// the Haar measure, density (1 - cos angle), cut to that interval.
Eigen::Quaterniond DrawGoal(Rng& rng, const Eigen::Quaterniond& q_WO, double min_angle,
                            double max_angle);

}  // namespace dexremoe
