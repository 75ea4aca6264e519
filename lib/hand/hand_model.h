// The hand: links, joints, limits, servos and colliders, as constants of a run.
//
// World frame W: origin and axes of the hand's base link P; the hand hangs palm down, so base +z
// (out of the palm) is world "down" and gravity acts along +z_P. We compute in P throughout:
// W = P with gravity (0, 0, +9.81).
#pragma once

#include <string>
#include <vector>

#include "base/options.h"
#include "geometry/mesh.h"
#include "geometry/pose.h"

namespace dexremoe {

// Servo and contact parameters that URDF files do not hold or hold wrongly (FACTS: effort 10 is a
// placeholder; an XL330-M288-T stalls at 0.52 N m).
// Register adds --hand=FILE as a short form of --hand.urdf=FILE.
struct HandOptions {
  std::string urdf = "data/hand/gx11.urdf";
  double kp = 3;                    // N m / rad
  double kd = 0.1;                  // N m s / rad
  double torque_limit = 0.5;        // N m; the smaller of this and the URDF's effort
  double speed_limit = 6.2;         // rad/s; the smaller of this and the URDF's velocity
  double armature = 0.0015;         // kg m^2, reflected rotor inertia
  void Register(Options& options);  // section "hand"
};

enum class ColliderShape { kSphere, kCapsule, kBox, kHull };

// A convex collider fixed to a link. Capsules run along their own z.
struct Collider {
  std::string name;
  ColliderShape shape = ColliderShape::kSphere;
  int link = 0;
  Pose X_LC;               // collider in link frame
  double radius = 0;       // sphere, capsule; m
  double half_length = 0;  // capsule: half the distance of end centres; m
  Eigen::Vector3d half_size = Eigen::Vector3d::Zero();  // box; m
  TriMesh hull;                                         // kHull: convex, in collider frame; m
  bool fingertip = false;
};

// A moving link (or the base, index 0). Fixed joints are merged: masses, visuals and colliders of
// the child move to the parent.
struct Link {
  std::string name;
  int parent = -1;                                    // link index; -1 for the base
  int chain = -1;                                     // finger 0 thumb, 1 index, 2 middle; -1 base
  double mass = 0;                                    // kg
  Eigen::Vector3d com = Eigen::Vector3d::Zero();      // p_Lcom, m
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // about com, in L axes; kg m^2
  TriMesh visual;                                     // in L; may be empty
  std::vector<Eigen::Vector3f> visual_color;          // red, green, blue in 0..1 per vertex
};

// Joint j moves link j + 1: X_parent_child(q) = X_PJ * Rotation(axis, q).
struct Joint {
  std::string name;
  int parent = 0;                                   // link index
  int child = 0;                                    // link index = joint index + 1
  Pose X_PJ;                                        // joint origin in the parent link
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  // in the child link
  double lower = 0, upper = 0;                      // rad
  double torque_limit = 0, speed_limit = 0;         // N m, rad/s
};

struct HandModel {
  std::string name;
  std::string source;         // URDF path
  std::vector<Link> links;    // links[0] is the base
  std::vector<Joint> joints;  // parents before children
  std::vector<Collider> colliders;
  std::vector<std::vector<int>> chains;  // joint indices per finger, base to tip
  std::vector<Pose> tip_frames;          // per chain: fingertip frame in its last link
  double kp = 0, kd = 0, armature = 0;

  int num_joints() const { return static_cast<int>(joints.size()); }
};

// Reads a URDF with a fixed base and serial chains of revolute joints. Chains are ordered by the
// natural order of their first joints' names ("joint2" before "joint10"). URDF has no capsule: a
// <cylinder> in a collision (or visual) element whose name ends in "_capsule" is one, its length
// being the distance of the cap centres. Meshes are found relative to the URDF, package:// names by
// their path inside the package; mesh colliders become convex parts. The colliders of the last URDF
// link of a chain (fixed tips included) are marked as fingertip.
// Throws Error naming file, link or joint, what was expected and what was found.
HandModel LoadHand(const HandOptions& options);

// X_WL of every link at joint angles q [num_joints], rad.
std::vector<Pose> ForwardKinematics(const HandModel& hand, const double* q);

}  // namespace dexremoe
