// The MuJoCo engine: an optional referee for evaluation and validation, not for training.
//
// Todorov, Erez, Tassa, "MuJoCo: A physics engine for model-based control", IROS 2012. It is
// compiled where <mujoco/mujoco.h> was found (package libmujoco-dev).
#pragma once

#include <memory>
#include <vector>

#include "sim/batch_sim.h"

namespace dexremoe {

// Whether this build has the engine.
bool MujocoAvailable();

// As MakeBatchSim. The referee runs at 16 or 17 substeps of 1/60 s (about 1 ms); fewer are possible
// and coarser. options.max_contacts, inner_steps and iterations do not apply: all contacts count
// and the solver runs to convergence. Colliders and parts are the convex hulls of their vertices.
// Throws Error when this build has no MuJoCo, or naming the object that MuJoCo refuses and why.
std::unique_ptr<BatchSim> MakeMujocoSim(const SimOptions& options, const HandModel& hand,
                                        std::vector<SimObject> objects, int num_envs,
                                        ThreadPool& pool);

}  // namespace dexremoe
