// The ODE engine: one dynamics world per environment, solved by the direct method (dWorldStep).
#pragma once

#include <memory>
#include <vector>

#include "sim/batch_sim.h"

namespace dexremoe {

// As MakeBatchSim. Throws Error when a part of an object or a collider is not a convex body, or a
// mass or inertia is not positive.
std::unique_ptr<BatchSim> MakeOdeSim(const SimOptions& options, const HandModel& hand,
                                     std::vector<SimObject> objects, int num_envs,
                                     ThreadPool& pool);

}  // namespace dexremoe
