// Surface normals through PCL.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "shape/cloud.h"

namespace dexremoe {

// Replaces cloud.normals by those of planes fitted to the `neighbors` nearest of `surface` (PCL's
// NormalEstimation), each on the side of the normal it replaces. Where no plane fits, the old
// normal stays.
void FitNormals(const std::vector<Eigen::Vector3d>& surface, int neighbors, PointCloud& cloud);

}  // namespace dexremoe
