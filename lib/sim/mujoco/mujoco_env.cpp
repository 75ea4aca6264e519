#if __has_include(<mujoco/mujoco.h>)
#include "sim/mujoco/mujoco_env.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace dexremoe {
namespace {

using Eigen::Vector3d;

// Added to all six directions of a held object: no force of a finger moves it visibly in a step,
// after which it is put back. Its softness in contact stays that of the free object.
constexpr double kHeldArmature = 1e3;  // kg, kg m^2
constexpr double kNoForce = 1e-4;      // N

}  // namespace

mjData& MujocoScratch::For(int object, const mjModel& model) {
  MujocoData& data = data_[object];
  if (data == nullptr) data.reset(mj_makeData(&model));
  return *data;
}

MujocoEnv::MujocoEnv(MujocoScene& scene)
    : scene_(scene),
      position_(scene.num_dofs() + 1),
      velocity_(scene.num_dofs()),
      warm_(scene.num_dofs()),
      armature_(scene.num_dofs()),
      inertia_(scene.num_dofs()),
      tip_contact_(scene.hand().chains.size()) {
  ObjectPosition()[3] = 1;
  SetObject(0, EnvPhysics());
}

void MujocoEnv::SetObject(int object, const EnvPhysics& physics) {
  model_ = scene_.ModelFor(object, physics);
  object_ = object;
  physics_ = physics;
}

void MujocoEnv::SetState(const EnvState& state) {
  for (std::size_t j = 0; j < state.q.size(); ++j) {
    position_[scene_.DofOf(j)] = state.q[j];
    velocity_[scene_.DofOf(j)] = state.qd[j];
  }
  const Eigen::Quaterniond q = state.X_WO.q.normalized();
  const Vector3d com = state.X_WO * physics_.com, w_O = q.conjugate() * state.w;
  double* p = ObjectPosition();
  std::copy_n(com.data(), 3, p);
  p[3] = q.w(), p[4] = q.x(), p[5] = q.y(), p[6] = q.z();
  std::copy_n(state.v.data(), 3, ObjectVelocity());
  std::copy_n(w_O.data(), 3, ObjectVelocity() + 3);
  std::fill(warm_.begin(), warm_.end(), 0.0);
  std::fill(tip_contact_.begin(), tip_contact_.end(), 0);
  steps_ = 0;
  push_ = {};
  contact_count_ = 0;
  max_penetration_ = 0;
}

void MujocoEnv::SetHeld(bool held) {
  held_ = held;
  std::fill_n(ObjectVelocity(), 6, 0.0);
}

void MujocoEnv::Step(const double* targets, MujocoScratch& scratch) {
  mjData& data = scratch.For(object_, *model_);
  // A view of the shared model with numbers of this environment.
  mjModel model = *model_;
  model.dof_armature = armature_.data();
  std::copy_n(physics_.gravity.data(), 3, model.opt.gravity);
  model.dof_M0 = inertia_.data();
  for (int k = 0; k < 6; ++k) SetArmature(scene_.object_dof() + k, held_ ? kHeldArmature : 0.0);
  std::copy(position_.begin(), position_.end(), data.qpos);
  std::copy(velocity_.begin(), velocity_.end(), data.qvel);
  std::copy(warm_.begin(), warm_.end(), data.qacc_warmstart);
  if (!held_) std::copy(push_.begin(), push_.end(), data.xfrc_applied + 6 * scene_.object_body());
  for (int i = 0; i < scene_.options().substeps && Finite(); ++i) Substep(targets, model, data);
  std::fill_n(data.xfrc_applied + 6 * scene_.object_body(), 6, 0.0);
  std::copy_n(data.qacc_warmstart, warm_.size(), warm_.begin());
  push_ = {};
  ++steps_;
}

// MuJoCo's own mj_step starts an environment anew when a number goes bad; its two halves without
// that check leave the bad number to be seen.
void MujocoEnv::Substep(const double* targets, const mjModel& model, mjData& data) {
  for (int j = 0; j < scene_.hand().num_joints(); ++j) SetServo(j, targets[j], model, data);
  mj_forward(&model, &data);
  ReadContacts(model, data);
  mj_Euler(&model, &data);
  if (held_) {
    std::copy_n(ObjectPosition(), 7, data.qpos + scene_.object_dof());
    std::fill_n(data.qvel + scene_.object_dof(), 6, 0.0);
  }
  std::copy_n(data.qpos, position_.size(), position_.begin());
  std::copy_n(data.qvel, velocity_.size(), velocity_.begin());
  for (const mjtWarning warning : {mjWARN_CONTACTFULL, mjWARN_CNSTRFULL})
    if (data.warning[warning].number > 0)
      Fail("MuJoCo: expected at most {} contacts and {} constraint rows, found more", model.nconmax,
           model.njmax);
}

// The implicit servo B (drive - qd_new) with B = h kp + kd, that is kp (e - h qd_new) - kd qd_new
// for drive = kp e / B, where the speed limit bounds the drive. With qd_new = qd + h a the part
// -B h a moves to the left side of the equations of motion: h B counts as armature, and contacts
// are solved together with it. The torque varies with qd_new between its values at the present
// speed, at rest and at the speed of the unloaded rotor. Where one of the three is beyond the
// torque limit, the servo is explicit in this substep, which at 1 ms is a small difference.
void MujocoEnv::SetServo(int j, double target, const mjModel& model, mjData& data) {
  const Joint& joint = scene_.hand().joints[j];
  const int dof = scene_.DofOf(j);
  const double h = model.opt.timestep, speed = velocity_[dof];
  const double kp = scene_.hand().kp * physics_.kp_factor;
  const double kd = scene_.hand().kd * physics_.kd_factor;
  const double servo = h * kp + kd, rotor = scene_.hand().armature / h;
  const double error = std::clamp(target, joint.lower, joint.upper) - position_[dof];
  const double drive = std::clamp(kp * error / servo, -joint.speed_limit, joint.speed_limit);
  const double unloaded = (servo * drive + rotor * speed) / (servo + rotor);
  const auto [least, most] = std::minmax({speed, 0.0, unloaded});
  const double limit = joint.torque_limit;
  const bool within = servo * (drive - least) <= limit && servo * (drive - most) >= -limit;
  SetArmature(dof, scene_.hand().armature + (within ? h * servo : 0.0));
  data.qfrc_applied[dof] = std::clamp(servo * (drive - speed), -limit, limit);
}

void MujocoEnv::SetArmature(int dof, double armature) {
  armature_[dof] = armature;
  inertia_[dof] = model_->dof_M0[dof] + armature - model_->dof_armature[dof];
}

bool MujocoEnv::Finite() const {
  const auto finite = [](double v) { return std::isfinite(v); };
  return std::all_of(position_.begin(), position_.end(), finite) &&
         std::all_of(velocity_.begin(), velocity_.end(), finite);
}

void MujocoEnv::ReadContacts(const mjModel& model, const mjData& data) {
  std::fill(tip_contact_.begin(), tip_contact_.end(), 0);
  contact_count_ = 0;
  max_penetration_ = 0;
  const HandModel& hand = scene_.hand();
  for (int i = 0; i < data.ncon; ++i) {
    const mjContact& contact = data.contact[i];
    const int a = scene_.ColliderOf(contact.geom1), b = scene_.ColliderOf(contact.geom2);
    if (a >= 0 && b >= 0) continue;  // finger against finger
    max_penetration_ = std::max(max_penetration_, -contact.dist);
    if (contact.efc_address < 0) continue;
    mjtNum force[6];  // in the contact's frame, the normal first
    mj_contactForce(&model, &data, i, force);
    if (force[0] <= kNoForce) continue;
    ++contact_count_;
    const Collider& collider = hand.colliders[std::max(a, b)];
    if (collider.fingertip) tip_contact_[hand.links[collider.link].chain] = 1;
  }
}

Eigen::Quaterniond MujocoEnv::Rotation() const {
  const double* q = &position_[scene_.object_dof() + 3];
  return {q[0], q[1], q[2], q[3]};
}

void MujocoEnv::Read(SimState& state, int row) const {
  const int joints = scene_.hand().num_joints();
  for (int j = 0; j < joints; ++j) {
    state.joint_position[row * joints + j] = position_[scene_.DofOf(j)];
    state.joint_velocity[row * joints + j] = velocity_[scene_.DofOf(j)];
  }
  const double* com = &position_[scene_.object_dof()];
  const double* velocity = &velocity_[scene_.object_dof()];
  const Vector3d p = Vector3d(com) - Rotation() * physics_.com;
  const Vector3d w = Rotation() * Vector3d(velocity + 3);
  std::copy_n(p.data(), 3, &state.object_position[3 * row]);
  std::copy_n(com + 3, 4, &state.object_rotation[4 * row]);
  std::copy_n(velocity, 3, &state.object_velocity[3 * row]);
  std::copy_n(w.data(), 3, &state.object_spin[3 * row]);
  std::copy(tip_contact_.begin(), tip_contact_.end(),
            state.tip_contact.begin() + row * tip_contact_.size());
  state.contact_count[row] = contact_count_;
  state.max_penetration[row] = max_penetration_;
}

}  // namespace dexremoe
#endif
