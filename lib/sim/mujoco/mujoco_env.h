// One environment: its model and the state that MuJoCo integrates. mjData is scratch space of a
// worker, filled from here before a step.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/bytes.h"
#include "sim/mujoco/mujoco_scene.h"

namespace dexremoe {

// mjData of one worker, one of each object it has met (their sizes differ).
class MujocoScratch {
 public:
  explicit MujocoScratch(std::size_t num_objects) : data_(num_objects) {}
  mjData& For(int object, const mjModel& model);
  // After an error in the middle of a step.
  void Discard(int object) { data_[object].reset(); }

 private:
  std::vector<MujocoData> data_;
};

class MujocoEnv {
 public:
  explicit MujocoEnv(MujocoScene& scene);

  void SetObject(int object, const EnvPhysics& physics);
  void SetState(const EnvState& state);
  void SetHeld(bool held);
  void Push(const Eigen::Vector3d& force) { push_ = {force.x(), force.y(), force.z()}; }
  void Save(ByteWriter& out) const;
  void Restore(ByteReader& in);

  // One control step. targets [num_joints], rad. Throws Error when MuJoCo fails.
  void Step(const double* targets, MujocoScratch& scratch);
  int object() const { return object_; }
  // Control steps since SetState.
  std::int64_t steps() const { return steps_; }
  // Copies the state into row `row` of the arrays; columns as in SimState.
  void Read(SimState& state, int row) const;

 private:
  void Substep(const double* targets, const mjModel& model, mjData& data);
  void SetServo(int joint, double target, const mjModel& model, mjData& data);
  void SetArmature(int dof, double armature);
  void ReadContacts(const mjModel& model, const mjData& data);
  bool Finite() const;
  Eigen::Quaterniond Rotation() const;
  // Columns of the object in qpos (position of the centre of mass, quaternion w x y z) and qvel
  // (velocity of the centre of mass in W, angular velocity in O).
  double* ObjectPosition() { return &position_[scene_.object_dof()]; }
  double* ObjectVelocity() { return &velocity_[scene_.object_dof()]; }

  MujocoScene& scene_;
  std::shared_ptr<const mjModel> model_;

  // | name       | shape  | unit       | meaning                                  |
  // | position_  | [J+7]  | rad, m, 1  | qpos                                     |
  // | velocity_  | [J+6]  | rad/s, m/s | qvel                                     |
  // | warm_      | [J+6]  | rad/s^2..  | the last acceleration: where the solver starts |
  std::vector<double> position_, velocity_, warm_;
  // Scratch of a substep, in place of the model's dof_armature and dof_M0 (the inertia of bodies
  // whose joint space inertia is constant); kg m^2, kg.
  std::vector<double> armature_, inertia_;
  std::int64_t steps_ = 0;
  int object_ = 0;
  EnvPhysics physics_;
  bool held_ = false;
  std::array<double, 3> push_{};           // N
  std::vector<std::uint8_t> tip_contact_;  // [F]
  int contact_count_ = 0;
  double max_penetration_ = 0;  // m
};

}  // namespace dexremoe
