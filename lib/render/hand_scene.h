// The hand as items of a scene, and the camera that shows it palm down.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "hand/hand_model.h"
#include "render/camera.h"
#include "render/renderer.h"
#include "render/scene.h"

namespace dexremoe {

// Where the goal's ghost stands: beside the hand, below the object, or over it; kNone shows the
// hand alone.
enum class GoalPlace { kBeside, kBelow, kOver, kNone };
// "beside", "below" or "over"; throws Error for another word.
GoalPlace PlaceNamed(const std::string& word);

// Shows the space under the palm from the open side between thumb and fingers. World +z (gravity)
// points down in the image. Room for the ghost is left where `place` puts it.
Camera HandCamera(GoalPlace place, double aspect);
// From the object to its ghost, m in W.
Eigen::Vector3d GoalOffset(GoalPlace place, const Camera& camera);

// Links, and colliders on request, of one hand. The renderer must outlive it and keep its meshes.
class HandScene {
 public:
  HandScene(Renderer& renderer, const HandModel& hand);

  // q [num_joints], rad. Links without a mesh of their own show their colliders.
  void Add(const double* q, Scene& scene) const;
  // The convex shapes of the simulation, translucent.
  void AddColliders(const double* q, Scene& scene) const;

 private:
  struct Part {
    int mesh = 0;
    int link = 0;
    Pose X_LM;
    Material material;
  };
  static void AddParts(const std::vector<Part>& parts, const std::vector<Pose>& X_WL, Scene& scene);
  const HandModel& hand_;
  std::vector<Part> links_, colliders_;
};

// The hand alone at joint angles q, rad. Throws Error when their number is not the hand's.
Image HandPicture(Renderer& renderer, const HandModel& hand, const std::vector<double>& q,
                  bool colliders, int width, int height);

// The hand as it looks and, to its right, as the convex parts that it collides with, each in a
// colour of its own. Throws as HandPicture does.
Image HandPartsPicture(Renderer& renderer, const HandModel& hand, const std::vector<double>& q,
                       int width, int height);

}  // namespace dexremoe
