// A pinhole camera.
#pragma once

#include <Eigen/Core>

#include "geometry/mesh.h"

namespace dexremoe {

struct Sphere {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // m
  double radius = 0;                                 // m
};

// Looks from `eye` to `target`, both in W, m. Right is view x `up`.
struct Camera {
  Eigen::Vector3d eye = Eigen::Vector3d(0, -1, 0);
  Eigen::Vector3d target = Eigen::Vector3d::Zero();
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  double fov_y = 0.5;  // rad, full vertical angle

  // Unit axes of the image in W: to the right, upwards, towards the viewer.
  Eigen::Matrix3d Axes() const;
  // Homogeneous W -> camera (x right, y up, -z forward).
  Eigen::Matrix4d View() const;
  // Camera -> clip, depths in [near, far], m; aspect = width / height.
  Eigen::Matrix4d Projection(double aspect, double near, double far) const;
  // Pixel coordinates (x right, y down, the first pixel's centre at 0.5) and depth in m of a point.
  Eigen::Vector3d Project(const Eigen::Vector3d& p_W, int width, int height) const;
};

// Looks along -`from` (any length) at a sphere so that it fills `fill` of the image's smaller side.
Camera FrameSphere(const Sphere& sphere, const Eigen::Vector3d& from, const Eigen::Vector3d& up,
                   double fov_y, double aspect, double fill = 0.9);

// The sphere about the centre of the box of all vertices.
Sphere BoundingSphere(const TriMesh& mesh);

}  // namespace dexremoe
