// The cache of stable grasps of one object: grasps.h5.
#pragma once

#include <string>
#include <vector>

#include "io/h5.h"
#include "task/object_set.h"

namespace dexremoe {

inline constexpr H5Format kGraspsFormat = {"dexremoe.grasps", 1};

struct GraspSet {
  std::vector<Grasp> grasps;  // all of one hand: equally many joints
  double acceptance = 0;      // kept (accepted, and certified where asked for) / tried candidates
};

void WriteGrasps(const std::string& path, const GraspSet& set, const Provenance& provenance);
// Throws Error naming file and dataset.
GraspSet ReadGrasps(const std::string& path);

}  // namespace dexremoe
