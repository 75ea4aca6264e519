#include "render/frame.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace dexremoe {
namespace {

Sphere Around(const std::vector<Sphere>& spheres) {
  Sphere around;
  if (spheres.empty()) return around;
  Box3 box;
  for (const Sphere& s : spheres) {
    box.Extend(s.center - Eigen::Vector3d::Constant(s.radius));
    box.Extend(s.center + Eigen::Vector3d::Constant(s.radius));
  }
  around.center = box.Center();
  for (const Sphere& s : spheres)
    around.radius = std::max(around.radius, (s.center - around.center).norm() + s.radius);
  return around;
}

// Axes of the light, from a point that it looks at; camera axes in, light axes out.
Eigen::Matrix4d LightView(const Eigen::Vector3d& light, const Eigen::Vector3d& center) {
  const Eigen::Vector3d side = light.unitOrthogonal();
  Eigen::Matrix3d axes;
  axes << side, light.cross(side), light;
  Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
  view.topLeftCorner<3, 3>() = axes.transpose();
  view.topRightCorner<3, 1>() = -axes.transpose() * center;
  return view;
}

Item PlaceFloor(const Floor& floor) {
  Item item;
  item.X_WM.p = floor.point;
  item.X_WM.q = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), floor.normal);
  item.scale = floor.radius;
  return item;
}

// Sees everything between the planes closest around it.
void SetCamera(const Camera& camera, const Sphere& all, Frame& frame) {
  frame.tan_y = std::tan(camera.fov_y / 2);
  frame.view = camera.View();
  const double middle = (all.center - camera.eye).dot(-camera.Axes().col(2));
  const double far = std::max(middle + all.radius, 1e-3) * 1.01;
  const double near = std::max(middle - all.radius, far * 0.01) * 0.99;
  frame.projection = camera.Projection(frame.aspect, near, far);
  // Soft things follow the size of the picture, not of the scene: at the target a feature is a
  // fifteenth of the image's height.
  frame.feature = frame.tan_y * (camera.eye - camera.target).norm() / 7.5;
}

// An orthographic cube around the solid items; farther from the light is deeper.
void SetLight(const Sphere& solid, Frame& frame) {
  frame.light = frame.scene->light.normalized();
  const double r = std::max(solid.radius, 1e-6) * 1.02;
  frame.light_view = LightView(frame.light, (frame.view * solid.center.homogeneous()).head<3>());
  frame.light_projection = Eigen::Vector4d(1 / r, 1 / r, -1 / r, 1).asDiagonal();
  frame.light_extent = 2 * r;
}

}  // namespace

Frame MakeFrame(const Scene& scene, const Camera& camera, double aspect,
                const std::function<Sphere(const Item&)>& bounds) {
  Frame frame;
  frame.scene = &scene;
  frame.aspect = aspect;
  std::vector<Sphere> all, solid;
  for (const Item& item : scene.items) {
    const bool opaque = item.material.opacity >= 1;
    (opaque ? frame.opaque : frame.ghosts).push_back(&item);
    all.push_back(bounds(item));
    if (opaque) solid.push_back(all.back());
  }
  const auto distance = [&](const Item* item) {
    return (bounds(*item).center - camera.eye).norm();
  };
  std::stable_sort(frame.ghosts.begin(), frame.ghosts.end(),
                   [&](const Item* a, const Item* b) { return distance(a) > distance(b); });
  if (scene.floor) {
    frame.floor = PlaceFloor(*scene.floor);
    all.push_back({scene.floor->point, 1.5 * scene.floor->radius});
  }
  SetCamera(camera, Around(all), frame);
  SetLight(Around(solid), frame);
  return frame;
}

}  // namespace dexremoe
