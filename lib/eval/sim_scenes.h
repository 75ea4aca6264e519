// What the engines are measured on: objects made in code and a board to slide on.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hand/hand_model.h"
#include "sim/batch_sim.h"

namespace dexremoe {

// A body of uniform density from closed convex parts (any frame, m): moved so that its centre of
// mass is the origin. Where parts overlap the overlap weighs twice.
SimObject CompoundObject(const std::string& name, ConvexParts parts);

SimObject BoxObject(const std::string& name, const Eigen::Vector3d& size);

// The four shapes of the accuracy table: a cube of 55 mm, an L, an airplane with wings of 6 mm, and
// a mug: eight wall pieces around a hollow, a floor and a handle.
std::vector<SimObject> ValidationShapes();

// `count` different bodies of the size of a grasp: one box or hull with one to five smaller ones on
// it. Body number i depends on `seed` and i alone.
std::vector<SimObject> RandomCompounds(int count, std::uint64_t seed);

// A "hand" without joints: a board whose upper face (towards +z) is z = 0.
HandModel BoardHand();

}  // namespace dexremoe
