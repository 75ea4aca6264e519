// Shapes of one URDF link: colliders and the mesh that pictures show. Internal to lib/hand.
#pragma once

#include <urdf_model/link.h>

#include <string>
#include <vector>

#include "hand/hand_model.h"

namespace dexremoe::internal {

Pose PoseOf(const urdf::Pose& pose);

// Appends the colliders of `source`, whose frame B stands at X_LB in the moving link `link`.
// A <cylinder> in a collision element whose name ends in "_capsule" is a capsule: its length is the
// distance of the cap centres. Other cylinders and meshes become convex hulls; a mesh that fills
// less than 80 % of its hull is cut into convex parts. Throws Error naming `urdf_path`, the link
// and the file.
void AppendColliders(const std::string& urdf_path, const urdf::Link& source, int link,
                     const Pose& X_LB, bool fingertip, std::vector<Collider>& colliders);

// Appends the visual shapes of `source` to target.visual and target.visual_color.
void AppendVisuals(const std::string& urdf_path, const urdf::Link& source, const Pose& X_LB,
                   Link& target);

}  // namespace dexremoe::internal
