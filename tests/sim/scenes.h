// Small hands and objects for the simulator's tests.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sim/batch_sim.h"

namespace dexremoe::scenes {

inline TriMesh BoxMesh(const Eigen::Vector3d& size,
                       const Eigen::Vector3d& center = Eigen::Vector3d::Zero()) {
  TriMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back(center + 0.5 * Eigen::Vector3d(i & 1 ? size.x() : -size.x(),
                                                           i & 2 ? size.y() : -size.y(),
                                                           i & 4 ? size.z() : -size.z()));
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

inline SimObject Block(const Eigen::Vector3d& size) {
  SimObject object;
  object.name = "block";
  object.parts = {BoxMesh(size)};
  const Eigen::Vector3d s2 = size.cwiseProduct(size) / 12;
  object.unit_inertia =
      Eigen::Vector3d(s2.y() + s2.z(), s2.x() + s2.z(), s2.x() + s2.y()).asDiagonal();
  object.radius = 0.5 * size.norm();
  return object;
}

inline SimObject Cube(double side = 0.055) { return Block(Eigen::Vector3d::Constant(side)); }

// A hand with a base only, its palm a box whose top face (towards +z) is z = 0.
inline HandModel PalmOnly() {
  HandModel hand;
  hand.name = "palm";
  hand.links.resize(1);
  hand.links[0].name = "base";
  Collider palm;
  palm.name = "palm";
  palm.shape = ColliderShape::kBox;
  palm.half_size = {0.3, 0.3, 0.02};
  palm.X_LC.p = {0, 0, -0.02};
  hand.colliders = {palm};
  hand.kp = 3;
  hand.kd = 0.1;
  return hand;
}

// One link turning about y through the origin, its mass on the axis: the rotor alone counts.
inline HandModel Rotor(double inertia = 1e-4) {
  HandModel hand = PalmOnly();
  hand.colliders.clear();
  hand.armature = 0.0015;
  Link link;
  link.name = "rotor";
  link.parent = 0;
  link.chain = 0;
  link.mass = 0.05;
  link.inertia = inertia * Eigen::Matrix3d::Identity();
  hand.links.push_back(link);
  Joint joint;
  joint.name = "axis";
  joint.child = 1;
  joint.axis = Eigen::Vector3d::UnitY();
  joint.lower = -2;
  joint.upper = 2;
  joint.torque_limit = 1e3;
  joint.speed_limit = 1e3;
  hand.joints = {joint};
  hand.chains = {{0}};
  hand.tip_frames = {Pose()};
  return hand;
}

// A simulator with its threads.
struct Rig {
  Rig(const SimOptions& options, const HandModel& hand, std::vector<SimObject> objects,
      int num_envs = 1, int workers = 1)
      : pool(workers), sim(MakeBatchSim(options, hand, std::move(objects), num_envs, pool)) {}
  BatchSim* operator->() { return sim.get(); }

  ThreadPool pool;
  std::unique_ptr<BatchSim> sim;
};

inline EnvState StateAt(int joints, const Eigen::Vector3d& p) {
  EnvState state;
  state.q.assign(joints, 0.0);
  state.qd.assign(joints, 0.0);
  state.X_WO.p = p;
  return state;
}

}  // namespace dexremoe::scenes
