#include "render/hand_scene.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "hand/primitive_mesh.h"

namespace dexremoe {
namespace {

constexpr double kHandCrease = 0.5;  // rad; machined parts look machined

TriMesh ColliderMesh(const Collider& collider) {
  switch (collider.shape) {
    case ColliderShape::kSphere:
      return SphereMesh(collider.radius);
    case ColliderShape::kCapsule:
      return CylinderMesh(collider.radius, 2 * collider.half_length, true);
    case ColliderShape::kBox:
      return BoxMesh(2 * collider.half_size);
    case ColliderShape::kHull:
      break;
  }
  return collider.hull;
}

// The last link of a finger carries its tip.
bool IsTip(const HandModel& hand, int link) {
  return std::any_of(hand.chains.begin(), hand.chains.end(), [&](const std::vector<int>& chain) {
    return hand.joints[chain.back()].child == link;
  });
}

// What must be seen, m in the image plane at the target, and where its middle is.
struct View {
  double width, height;
  double right, up;  // from the middle of the hand
};

View ViewOf(GoalPlace place) {
  switch (place) {
    case GoalPlace::kBeside:
      return {0.365, 0.275, 0.045, -0.008};
    case GoalPlace::kBelow:
      return {0.25, 0.345, 0.004, -0.05};
    case GoalPlace::kOver:  // the free side is for the card of figures
      return {0.365, 0.275, 0.055, -0.002};
    case GoalPlace::kNone:
      break;
  }
  return {0.24, 0.225, -0.003, 0.012};
}

}  // namespace

GoalPlace PlaceNamed(const std::string& word) {
  if (word == "beside") return GoalPlace::kBeside;
  if (word == "below") return GoalPlace::kBelow;
  if (word == "over") return GoalPlace::kOver;
  Fail("goal: expected beside, below or over, found \"{}\"", word);
}

Camera HandCamera(GoalPlace place, double aspect) {
  const View view = ViewOf(place);
  Camera camera;
  camera.fov_y = 0.48;
  camera.up = -Eigen::Vector3d::UnitZ();
  const double height = std::max(view.height, view.width / aspect);
  const double distance = height / 2 / std::tan(camera.fov_y / 2);
  const Eigen::Vector3d middle(0, 0.075, 0.075);
  camera.target = middle;
  camera.eye = middle + distance * Eigen::Vector3d(-1, -0.45, 0.25).normalized();
  const Eigen::Matrix3d axes = camera.Axes();
  const Eigen::Vector3d shift = axes.col(0) * view.right + axes.col(1) * view.up;
  camera.target += shift;
  camera.eye += shift;
  return camera;
}

Eigen::Vector3d GoalOffset(GoalPlace place, const Camera& camera) {
  if (place == GoalPlace::kBeside)
    return 0.132 * camera.Axes().col(0) - 0.02 * camera.Axes().col(1);
  if (place == GoalPlace::kBelow) return -0.105 * camera.Axes().col(1);
  return Eigen::Vector3d::Zero();
}

HandScene::HandScene(Renderer& renderer, const HandModel& hand) : hand_(hand) {
  for (int l = 0; l < int(hand.links.size()); ++l) {
    if (hand.links[l].visual.triangles.empty()) continue;
    const Material& material = l == 0           ? palette::kPalm
                               : IsTip(hand, l) ? palette::kTip
                                                : palette::kLink;
    links_.push_back({renderer.AddMesh(hand.links[l].visual, kHandCrease), l, Pose{}, material});
  }
  for (const Collider& collider : hand.colliders) {
    Material material = palette::kGoal;
    material.color = palette::Distinct(collider.fingertip ? 1 : 4);
    material.opacity = 0.4f;
    const int mesh = renderer.AddMesh(ColliderMesh(collider), 0.4);
    colliders_.push_back({mesh, collider.link, collider.X_LC, material});
    if (hand.links[collider.link].visual.triangles.empty()) {
      links_.push_back(colliders_.back());
      links_.back().material = collider.link == 0 ? palette::kPalm : palette::kLink;
    }
  }
}

void HandScene::Add(const double* q, Scene& scene) const {
  AddParts(links_, ForwardKinematics(hand_, q), scene);
}

void HandScene::AddColliders(const double* q, Scene& scene) const {
  AddParts(colliders_, ForwardKinematics(hand_, q), scene);
}

void HandScene::AddParts(const std::vector<Part>& parts, const std::vector<Pose>& X_WL,
                         Scene& scene) {
  for (const Part& part : parts)
    scene.items.push_back({part.mesh, X_WL[part.link] * part.X_LM, 1, part.material});
}

namespace {

void CheckAngles(const HandModel& hand, const std::vector<double>& q) {
  if (int(q.size()) != hand.num_joints())
    Fail("{}: expected {} joint angles, found {}", hand.source, hand.num_joints(), q.size());
}

Image DrawHand(Renderer& renderer, const Scene& scene, int width, int height) {
  return renderer.Draw(scene, HandCamera(GoalPlace::kNone, double(width) / height), width, height);
}

}  // namespace

Image HandPicture(Renderer& renderer, const HandModel& hand, const std::vector<double>& q,
                  bool colliders, int width, int height) {
  CheckAngles(hand, q);
  const HandScene items(renderer, hand);
  Scene scene;
  items.Add(q.data(), scene);
  if (colliders) items.AddColliders(q.data(), scene);
  return DrawHand(renderer, scene, width, height);
}

Image HandPartsPicture(Renderer& renderer, const HandModel& hand, const std::vector<double>& q,
                       int width, int height) {
  CheckAngles(hand, q);
  const HandScene items(renderer, hand);
  Scene parts;
  items.AddColliders(q.data(), parts);
  for (std::size_t i = 0; i < parts.items.size(); ++i) {
    parts.items[i].material.color = palette::Distinct(int(i));
    parts.items[i].material.opacity = 1;
  }
  const int left_width = width / 2, right_width = width - left_width;
  const Image left = HandPicture(renderer, hand, q, false, left_width, height);
  const Image right = DrawHand(renderer, parts, right_width, height);
  Image both(width, height, 255, 255, 255);
  for (int y = 0; y < height; ++y) {
    std::copy_n(left.at(0, y), 3 * left_width, both.at(0, y));
    std::copy_n(right.at(0, y), 3 * right_width, both.at(left_width, y));
  }
  return both;
}

}  // namespace dexremoe
