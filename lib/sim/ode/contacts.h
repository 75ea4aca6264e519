// Contact generation for one environment: object against hand, and fingers against each other.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "hand/hand_model.h"
#include "sim/ode/manifold.h"

namespace dexremoe {

struct ContactPoint {
  Eigen::Vector3d position;  // W; m
  Eigen::Vector3d normal;    // W; from collider b (or the hand) to a (or the object)
  double gap = 0;            // m; negative when the surfaces overlap
  int collider = 0;          // of the hand, on the normal's tail
  int other = -1;            // second hand collider; -1: the object
};

// The hand's and the objects' convex shapes with what pairs can touch; constant during a run.
struct ContactModel {
  struct HandShape {
    ConvexShape shape;
    int link = 0;
    Pose X_LC;
  };
  struct ObjectShape {
    std::vector<ConvexShape> parts;
    double radius = 0;  // bounding sphere about O at scale 1; m
  };
  std::vector<HandShape> hand;
  std::vector<std::array<int, 2>> hand_pairs;  // fingertips of different fingers, tip and palm
  std::vector<ObjectShape> objects;
};

ContactModel::ObjectShape ShapeOfObject(const ConvexParts& parts, const std::string& name);
// Hand shapes and self pairs. Links next to each other never touch.
ContactModel ContactModelOf(const HandModel& hand);

struct LinkPose {
  Eigen::Matrix3d R;  // R_WL
  Eigen::Vector3d p;  // p_WL
};

// Scratch space of one worker; the result does not depend on earlier calls.
class ContactFinder {
 public:
  explicit ContactFinder(const ContactModel& model) : model_(model) {}

  // All points with gap <= margin between the hand and the object `object` at scale `scale` and
  // pose (R_WO, p_WO); at most max_points, the deepest of each collider first.
  const std::vector<ContactPoint>& ObjectContacts(const std::vector<LinkPose>& links, int object,
                                                  double scale, const LinkPose& X_WO, double margin,
                                                  int max_points);
  // Points between hand colliders of hand_pairs; a is hand_pairs[i][0].
  const std::vector<ContactPoint>& SelfContacts(const std::vector<LinkPose>& links, double margin);

 private:
  void AddColliderContacts(int collider, const PlacedShape& placed, double scale,
                           const LinkPose& X_WO, double margin);
  void Limit(int max_points);

  const ContactModel& model_;
  const ContactModel::ObjectShape* object_ = nullptr;
  std::vector<ContactPoint> points_, self_points_;
};

}  // namespace dexremoe
