// Small hands and objects for the simulator's tests, and what these expect of each engine.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "sim/batch_sim.h"
#include "sim/mujoco/mujoco_sim.h"

namespace dexremoe::scenes {

// Where engines rightly differ; everything else holds for all of them alike.
struct Engine {
  std::string name;
  std::vector<int> substeps;  // of 1/60 s, for the contact tests
  double round_off = 0;       // of a state set and read back, in its own units
  // Absolute errors against the closed forms of the integrator.
  double free_speed = 0, free_distance = 0;  // m/s, m
  double servo_speed = 0, servo_angle = 0;   // rad/s, rad
  // Height of a resting body over the surface below it.
  double rest_gap = 0, rest_gap_error = 0;  // m
  double slip_angle = 0;                    // largest error against atan mu; degrees
  double spin_creep = 0;                    // of a torque below the torsional bound; rad in 1 s
  double impact_depth = 0;                  // deepest overlap of a cube that fell 12 cm; m
  double stop_time = 0;  // s; a joint runs into its stop as far as its speed takes it in this time
};

inline void PrintTo(const Engine& engine, std::ostream* out) { *out << engine.name; }

inline std::vector<Engine> Engines() {
  Engine ode;
  ode.name = "ode";
  ode.substeps = {1, 2, 4};
  ode.round_off = 1e-9;  // joint angles are read off quaternions
  ode.free_speed = 1e-12;
  ode.free_distance = 1e-10;
  // Bodies turn by a first-order step of the quaternion: third order in h qd.
  ode.servo_speed = 5e-3;
  ode.servo_angle = 2e-4;
  // A skin of 0.1 mm keeps surfaces apart.
  ode.rest_gap = 1e-4;
  ode.rest_gap_error = 2e-5;
  ode.slip_angle = 0.5;
  ode.spin_creep = 0.01;
  ode.impact_depth = 2e-3;
  ode.stop_time = 1.0 / 240;  // a substep of four

  Engine lanes;
  lanes.name = "lanes";
  // At one substep a fall of 12 cm ends 6 mm deep.
  lanes.substeps = {2, 4};
  // float32 at 3 m, a hundred steps of it, and at 1 rad.
  lanes.round_off = 5e-7;
  lanes.free_speed = 2e-5;
  lanes.free_distance = 1e-4;
  lanes.servo_speed = 1e-4;
  lanes.servo_angle = 1e-5;
  // An overlap of up to 0.3 mm is left alone.
  lanes.rest_gap_error = 1e-4;
  // Normals come from the gradient of a sampled distance field.
  lanes.slip_angle = 2;
  lanes.spin_creep = 0.01;
  lanes.impact_depth = 2e-3;
  lanes.stop_time = 1.0 / 240;

  Engine mujoco;
  mujoco.name = "mujoco";
  mujoco.substeps = {16};  // the referee's 1 ms
  mujoco.round_off = 1e-14;
  mujoco.free_speed = 1e-12;
  mujoco.free_distance = 1e-10;
  mujoco.servo_speed = 1e-9;
  mujoco.servo_angle = 1e-9;
  // Contacts and stops are critically damped springs with time constants of 6 and 2 ms.
  mujoco.rest_gap = -2e-5;
  mujoco.rest_gap_error = 2e-5;
  mujoco.slip_angle = 0.3;
  mujoco.spin_creep = 0.05;
  mujoco.impact_depth = 3e-3;
  mujoco.stop_time = 2e-3;
  return {ode, lanes, mujoco};
}

// A test that runs on every engine; it skips those that this build does not have.
class OnEveryEngine : public testing::TestWithParam<Engine> {
 protected:
  void SetUp() override {
    if (GetParam().name == "mujoco" && !MujocoAvailable())
      GTEST_SKIP() << "this build has no MuJoCo (libmujoco-dev)";
  }
  SimOptions Options(int substeps = 2) const {
    SimOptions options;
    options.engine = GetParam().name;
    options.substeps = substeps;
    return options;
  }
  // Length of the integrator's step; s.
  static double TimeStep(const SimOptions& options) {
    const int inner = options.engine == "lanes" ? options.inner_steps : 1;
    return 1 / (options.control_rate * options.substeps * inner);
  }
};

inline std::string EngineName(const testing::TestParamInfo<Engine>& info) {
  return info.param.name;
}

#define DEX_RUN_ON_EVERY_ENGINE(suite)                                                       \
  INSTANTIATE_TEST_SUITE_P(Engines, suite, testing::ValuesIn(::dexremoe::scenes::Engines()), \
                           ::dexremoe::scenes::EngineName)

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
