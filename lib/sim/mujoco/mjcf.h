// The hand and one object as MuJoCo's model text (MJCF).
#pragma once

#include <string>

#include "sim/batch_sim.h"

namespace dexremoe {

// Names in the text: bodies "link1".. and "object", joints "joint0".., geoms and meshes
// "collider0".. of hand.colliders and "part0".. of the object's parts.
//
// The object's body frame has its origin at the centre of mass, here that of O; the object has
// mass 1, scale 1 and no friction, and there is no gravity: see MujocoScene::ModelFor.
// Hand and object may touch, and fingertips of different fingers, or a fingertip and the palm,
// without friction. Throws Error when a mass or an inertia is not positive.
std::string MjcfOf(const HandModel& hand, const SimObject& object, double time_step);

}  // namespace dexremoe
