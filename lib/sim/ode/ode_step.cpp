// Advancing one environment: servos and the direct stepper.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "sim/ode/ode_env.h"

namespace dexremoe {
namespace {

using Eigen::Vector3d;

Vector3d ToVector(const dReal* v) { return {v[0], v[1], v[2]}; }

// Contact joints go with the step, also when it fails.
struct ContactJointsOfAStep {
  dJointGroupID group;
  ~ContactJointsOfAStep() { dJointGroupEmpty(group); }
};

}  // namespace

void OdeEnv::Step(const double* targets, ContactFinder& finder) {
  const double h = 1.0 / (model_.options.control_rate * model_.options.substeps);
  for (int i = 0; i < model_.options.substeps; ++i) Substep(targets, h, finder);
  push_ = {};
  ++steps_;
}

void OdeEnv::Substep(const double* targets, double h, ContactFinder& finder) {
  const ContactJointsOfAStep contact_joints{arena_.contact_joints()};
  UpdateLinkPoses();
  for (int j = 0; j < model_.hand.num_joints(); ++j) SetServo(j, targets[j], h);
  CreateContacts(finder, h);
  if (!held_) dBodyAddForce(object_body_, push_[0], push_[1], push_[2]);
  dWorldStep(world_, h);
  CollectForces();
}

void OdeEnv::UpdateLinkPoses() {
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const dReal* R = dBodyGetRotation(links_[i]);
    LinkPose& pose = poses_[i + 1];
    pose.R << R[0], R[1], R[2], R[4], R[5], R[6], R[8], R[9], R[10];
    pose.p = ToVector(dBodyGetPosition(links_[i])) - pose.R * model_.hand.links[i + 1].com;
  }
}

// The implicit servo with reflected rotor inertia A, exactly, as soft rows about the axis. A row
// with target velocity c and softness 1/D exerts D (c - qd_new). With B = h kp + kd,
//   servo: D = B,   c = kp e / B  exerts kp (e - h qd_new) - kd qd_new, at most the torque limit T;
//   rotor: D = A/h, c = qd_old    exerts -A (qd_new - qd_old) / h, without a limit.
// Rows with bounds cost the stepper far more than rows without. The torque varies with qd_new
// between its values at the present speed, at rest and at the speed of the unloaded rotor: where
// all three lie within the limit, or all beyond it, the two rows become one without bounds.
void OdeEnv::SetServo(int j, double target, double h) {
  const HandModel& hand = model_.hand;
  const Joint& joint = hand.joints[j];
  const double kp = hand.kp * physics_.kp_factor, kd = hand.kd * physics_.kd_factor;
  const double servo = h * kp + kd, rotor = hand.armature / h;
  const double speed = dJointGetHingeAngleRate(hinges_[j]);
  const double error =
      std::clamp(target, joint.lower, joint.upper) - dJointGetHingeAngle(hinges_[j]);
  // The speed limit: the servo does not push a joint beyond it.
  const double drive = std::clamp(kp * error / servo, -joint.speed_limit, joint.speed_limit);
  const double unloaded = (servo * drive + rotor * speed) / (servo + rotor);
  const auto [least, most] = std::minmax({speed, 0.0, unloaded});
  const double highest = servo * (drive - least), lowest = servo * (drive - most);
  const double limit = joint.torque_limit;
  if (highest <= limit && lowest >= -limit) {
    SetRow(j, 0, unloaded, servo + rotor, dInfinity);
    SetRow(j, 1, 0, 1, 0);
  } else if (rotor > 0 && (lowest >= limit || highest <= -limit)) {
    SetRow(j, 0, speed + std::copysign(limit, drive) / rotor, rotor, dInfinity);
    SetRow(j, 1, 0, 1, 0);
  } else {
    SetRow(j, 0, drive, servo, limit);
    SetRow(j, 1, speed, rotor, rotor > 0 ? dInfinity : 0);
  }
}

// One row of servo j: stiffness * (speed - qd_new), at most `limit`; none for limit 0.
void OdeEnv::SetRow(int j, int row, double speed, double stiffness, double limit) {
  const int group = row == 0 ? dParamGroup1 : dParamGroup2;
  dJointSetAMotorParam(servos_[j], group | dParamVel, speed);
  dJointSetAMotorParam(servos_[j], group | dParamCFM, 1 / stiffness);
  dJointSetAMotorParam(servos_[j], group | dParamFMax, limit);
}

}  // namespace dexremoe
