#include "render/camera.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace dexremoe {

Eigen::Matrix3d Camera::Axes() const {
  const Eigen::Vector3d back = (eye - target).normalized();
  const Eigen::Vector3d right = up.cross(back).normalized();
  Eigen::Matrix3d axes;
  axes << right, back.cross(right), back;
  return axes;
}

Eigen::Matrix4d Camera::View() const {
  const Eigen::Matrix3d R_CW = Axes().transpose();
  Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
  view.topLeftCorner<3, 3>() = R_CW;
  view.topRightCorner<3, 1>() = -R_CW * eye;
  return view;
}

Eigen::Matrix4d Camera::Projection(double aspect, double near, double far) const {
  const double focal = 1 / std::tan(fov_y / 2);
  Eigen::Matrix4d projection = Eigen::Matrix4d::Zero();
  projection(0, 0) = focal / aspect;
  projection(1, 1) = focal;
  projection(2, 2) = (far + near) / (near - far);
  projection(2, 3) = 2 * far * near / (near - far);
  projection(3, 2) = -1;
  return projection;
}

Eigen::Vector3d Camera::Project(const Eigen::Vector3d& p_W, int width, int height) const {
  const Eigen::Vector3d p_C = Axes().transpose() * (p_W - eye);
  const double depth = -p_C.z();
  const double pixels = height / 2.0 / std::tan(fov_y / 2);  // focal length
  return {width / 2.0 + pixels * p_C.x() / depth, height / 2.0 - pixels * p_C.y() / depth, depth};
}

Camera FrameSphere(const Sphere& sphere, const Eigen::Vector3d& from, const Eigen::Vector3d& up,
                   double fov_y, double aspect, double fill) {
  const double half = std::atan(fill * std::tan(fov_y / 2) * std::min(1.0, aspect));
  Camera camera;
  camera.target = sphere.center;
  camera.eye = sphere.center + from.normalized() * (sphere.radius / std::sin(half));
  camera.up = up;
  camera.fov_y = fov_y;
  return camera;
}

Sphere BoundingSphere(const TriMesh& mesh) {
  Sphere sphere;
  if (mesh.vertices.empty()) return sphere;
  Box3 box;
  for (const Eigen::Vector3d& vertex : mesh.vertices) box.Extend(vertex);
  sphere.center = box.Center();
  for (const Eigen::Vector3d& vertex : mesh.vertices)
    sphere.radius = std::max(sphere.radius, (vertex - sphere.center).norm());
  return sphere;
}

}  // namespace dexremoe
