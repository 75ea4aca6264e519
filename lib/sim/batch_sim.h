// The one simulator interface: N independent hand-object environments advanced together.
//
// Callers hand in joint targets for all environments and read state arrays back. Nothing above
// sim/ knows which engine runs. World frame W = palm frame P (see hand/hand_model.h).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/options.h"
#include "base/thread_pool.h"
#include "geometry/mesh.h"
#include "hand/hand_model.h"

namespace dexremoe {

struct SimOptions {
  std::string engine = "ode";  // ode, lanes or mujoco
  int substeps = 2;            // physics steps per control step (evidence: README, "Physics")
  int inner_steps = 2;         // lanes: time steps per physics step, contacts found once
  int iterations = 3;          // lanes: solver sweeps per time step
  std::string instructions = "auto";  // lanes: auto, avx512, avx2, sse4 or portable
  double control_rate = 60;           // Hz (paper)
  double gravity = 9.81;              // m/s^2 along +z_P (palm down)
  int max_contacts = 12;              // ode: per environment
  void Register(Options& options);    // section "sim"
};

// An object as the engines see it. Body frame O: origin at the centre of mass.
struct SimObject {
  std::string name;
  ConvexParts parts;                                           // in O, at scale 1; m
  Eigen::Matrix3d unit_inertia = Eigen::Matrix3d::Identity();  // inertia / mass; m^2
  double radius = 0;                                           // bounding sphere about O; m
};

// Physical parameters of one environment; constant during an episode.
struct EnvPhysics {
  double mass = 0.1;                                      // kg
  Eigen::Vector3d com = Eigen::Vector3d::Zero();          // offset of the centre of mass in O; m
  double friction = 1.0;                                  // Coulomb coefficient, hand-object
  double scale = 1.0;                                     // uniform size factor
  double kp_factor = 1.0, kd_factor = 1.0;                // servo gains relative to the hand's
  Eigen::Vector3d gravity = Eigen::Vector3d(0, 0, 9.81);  // m/s^2 in W
  // Soft fingers: a moment m resists spin about a contact's normal. With its normal force n and
  // tangential force t, (t / friction)^2 + (m / torsional_friction)^2 <= n^2 (Howe and Cutkosky,
  // "Practical force-motion models for sliding manipulation", IJRR 1996). A patch of radius r under
  // even pressure has 2/3 friction r; a point 0; m.
  double torsional_friction = 0;
};

// State of one environment in generalised coordinates.
struct EnvState {
  std::vector<double> q, qd;                    // joints: rad, rad/s
  Pose X_WO;                                    // object pose
  Eigen::Vector3d v = Eigen::Vector3d::Zero();  // object centre-of-mass velocity in W; m/s
  Eigen::Vector3d w = Eigen::Vector3d::Zero();  // object angular velocity in W; rad/s
};

// State arrays of all environments after the last step, row = environment, double.
// | name             | shape  | unit    | written by  |
// | joint_position   | [N,J]  | rad     | Step, SetState |
// | joint_velocity   | [N,J]  | rad/s   | Step, SetState |
// | object_position  | [N,3]  | m, W    | Step, SetState |
// | object_rotation  | [N,4]  | w x y z | Step, SetState |
// | object_velocity  | [N,3]  | m/s, W  | Step, SetState |
// | object_spin      | [N,3]  | rad/s,W | Step, SetState |
// | tip_contact      | [N,F]  | 1       | Step: 1 when finger f's tip touches the object |
// | contact_count    | [N]    | 1       | Step: hand-object contact points in the last substep |
// | max_penetration  | [N]    | m       | Step: deepest hand-object contact in the last substep |
struct SimState {
  std::vector<double> joint_position, joint_velocity;
  std::vector<double> object_position, object_rotation, object_velocity, object_spin;
  std::vector<std::uint8_t> tip_contact;
  std::vector<int> contact_count;
  std::vector<double> max_penetration;
};

class BatchSim {
 public:
  virtual ~BatchSim() = default;

  virtual int num_envs() const = 0;
  virtual int num_joints() const = 0;
  virtual const SimState& state() const = 0;

  // Puts object `object` (index into the list given to MakeBatchSim) with these parameters into
  // environment env. Call SetState afterwards.
  virtual void SetObject(int env, int object, const EnvPhysics& physics) = 0;
  // Copies a state in; velocities included, contact history cleared.
  virtual void SetState(int env, const EnvState& state) = 0;
  EnvState GetState(int env) const;
  // The engine's whole state of env as bytes, and back: a restored environment continues bit for
  // bit.
  virtual std::vector<std::uint8_t> Save(int env) const = 0;
  virtual void Restore(int env, std::span<const std::uint8_t> bytes) = 0;

  // While held, the object is kinematic at its pose (grasp search closes the fingers around it).
  virtual void SetHeld(int env, bool held) = 0;
  // External force on the object's centre of mass during the next Step, N in W; cleared after it.
  virtual void PushObject(int env, const Eigen::Vector3d& force) = 0;

  // One control step (1 / control_rate s) of all environments with active[env] != 0 (all when
  // empty). targets [N,J], rad. Throws Error naming environment, step and field when a state is
  // not finite.
  virtual void Step(std::span<const double> targets, std::span<const std::uint8_t> active = {}) = 0;
};

// Builds the engine named in options. Environment env belongs to a fixed chunk of work, so results
// are equal bit for bit for any number of workers. `pool` must outlive the simulator.
std::unique_ptr<BatchSim> MakeBatchSim(const SimOptions& options, const HandModel& hand,
                                       std::vector<SimObject> objects, int num_envs,
                                       ThreadPool& pool);

}  // namespace dexremoe
