// Building the world of one environment and setting its state.
#include "sim/ode/ode_env.h"

#include <Eigen/Geometry>

#include "base/check.h"
#include "base/error.h"

namespace dexremoe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Joint and limit errors are corrected by this share in a step. Softness keeps redundant rows
// solvable; at 1e-9 it is far below any contact's.
constexpr double kJointErp = 0.8;
constexpr double kWorldCfm = 1e-9;  // (m/s) / N

void SetMass(dBodyID body, double mass, const Matrix3d& inertia, const std::string& what) {
  if (!(mass > 0)) Fail("{}: mass: expected > 0 kg, found {}", what, mass);
  if (!(inertia.determinant() > 0)) Fail("{}: inertia: expected a positive definite matrix", what);
  dMass m;
  dMassSetParameters(&m, mass, 0, 0, 0, inertia(0, 0), inertia(1, 1), inertia(2, 2), inertia(0, 1),
                     inertia(0, 2), inertia(1, 2));
  dBodySetMass(body, &m);
}

}  // namespace

OdeEnv::OdeEnv(const OdeModel& model, OdeArena& arena)
    : model_(model), arena_(arena), world_(arena.CreateWorld()) {
  dWorldSetERP(world_, kJointErp);
  dWorldSetCFM(world_, kWorldCfm);
  CreateBodies();
  CreateJoints();
  tip_contact_.assign(model.hand.chains.size(), 0);
  poses_.resize(model.hand.links.size());
  poses_[0] = {Matrix3d::Identity(), Vector3d::Zero()};
  active_.reserve(model.options.max_contacts);
  forces_.reserve(model.options.max_contacts);
  SetObject(0, EnvPhysics());
}

OdeEnv::~OdeEnv() { dWorldDestroy(world_); }

void OdeEnv::CreateBodies() {
  const HandModel& hand = model_.hand;
  const std::vector<double> zero(hand.num_joints(), 0.0);
  const std::vector<Pose> X_WL = ForwardKinematics(hand, zero.data());
  for (std::size_t i = 1; i < hand.links.size(); ++i) {
    const Link& link = hand.links[i];
    const dBodyID body = dBodyCreate(world_);
    SetMass(body, link.mass, link.inertia, "link " + link.name);
    SetBodyPose(body, X_WL[i].q, X_WL[i] * link.com);
    // The links' gyroscopic torques are far below the servos' and cost stability.
    dBodySetGyroscopicMode(body, 0);
    links_.push_back(body);
  }
  object_body_ = dBodyCreate(world_);
  dBodySetGyroscopicMode(object_body_, 1);
}

void OdeEnv::CreateJoints() {
  const HandModel& hand = model_.hand;
  const std::vector<double> zero(hand.num_joints(), 0.0);
  const std::vector<Pose> X_WL = ForwardKinematics(hand, zero.data());
  for (const Joint& joint : hand.joints) {
    const dBodyID child = links_[joint.child - 1];
    const dBodyID parent = joint.parent == 0 ? nullptr : links_[joint.parent - 1];
    const Vector3d p = X_WL[joint.child].p, axis = X_WL[joint.child].q * joint.axis;
    const dJointID hinge = dJointCreateHinge(world_, nullptr);
    dJointAttach(hinge, child, parent);
    dJointSetHingeAnchor(hinge, p.x(), p.y(), p.z());
    dJointSetHingeAxis(hinge, axis.x(), axis.y(), axis.z());
    dJointSetHingeParam(hinge, dParamLoStop, joint.lower);
    dJointSetHingeParam(hinge, dParamHiStop, joint.upper);
    dJointSetHingeParam(hinge, dParamStopERP, kJointErp);
    hinges_.push_back(hinge);
    // Up to two rows about the hinge's axis, set before every step (see SetServo).
    const dJointID servo = dJointCreateAMotor(world_, nullptr);
    dJointAttach(servo, child, parent);
    dJointSetAMotorMode(servo, dAMotorUser);
    dJointSetAMotorNumAxes(servo, 2);
    for (const int row : {0, 1}) dJointSetAMotorAxis(servo, row, 1, axis.x(), axis.y(), axis.z());
    servos_.push_back(servo);
  }
}

void OdeEnv::SetObject(int object, const EnvPhysics& physics) {
  DEX_CHECK_GE(object, 0);
  DEX_CHECK_LT(object, static_cast<int>(model_.objects.size()));
  object_ = object;
  physics_ = physics;
  SetObjectMass();
  dWorldSetGravity(world_, physics.gravity.x(), physics.gravity.y(), physics.gravity.z());
}

void OdeEnv::SetObjectMass() {
  const SimObject& object = model_.objects[object_];
  const double factor = physics_.mass * physics_.scale * physics_.scale;
  SetMass(object_body_, physics_.mass, factor * object.unit_inertia, "object " + object.name);
}

void OdeEnv::SetBodyPose(dBodyID body, const Eigen::Quaterniond& q, const Vector3d& p) {
  const dQuaternion quaternion = {q.w(), q.x(), q.y(), q.z()};
  dBodySetQuaternion(body, quaternion);
  dBodySetPosition(body, p.x(), p.y(), p.z());
}

void OdeEnv::SetState(const EnvState& state) {
  DEX_CHECK_EQ(static_cast<int>(state.q.size()), model_.hand.num_joints());
  DEX_CHECK_EQ(state.qd.size(), state.q.size());
  SetLinkStates(state);
  SetBodyPose(object_body_, state.X_WO.q, state.X_WO * physics_.com);
  dBodySetLinearVel(object_body_, state.v.x(), state.v.y(), state.v.z());
  dBodySetAngularVel(object_body_, state.w.x(), state.w.y(), state.w.z());
  steps_ = 0;
  push_ = {};
  forces_.clear();
  tip_contact_.assign(tip_contact_.size(), 0);
  contact_count_ = 0;
  max_penetration_ = 0;
}

// Velocities outwards along the chains: w = w_parent + axis qd, and the joint's origin moves with
// the parent.
void OdeEnv::SetLinkStates(const EnvState& state) {
  const HandModel& hand = model_.hand;
  const std::vector<Pose> X_WL = ForwardKinematics(hand, state.q.data());
  std::vector<Vector3d> v(hand.links.size(), Vector3d::Zero()), w(v);  // of the link origins
  for (int j = 0; j < hand.num_joints(); ++j) {
    const Joint& joint = hand.joints[j];
    const int child = joint.child, parent = joint.parent;
    w[child] = w[parent] + state.qd[j] * (X_WL[child].q * joint.axis);
    v[child] = v[parent] + w[parent].cross(X_WL[child].p - X_WL[parent].p);
    const Vector3d com = X_WL[child] * hand.links[child].com;
    const Vector3d v_com = v[child] + w[child].cross(com - X_WL[child].p);
    const dBodyID body = links_[child - 1];
    SetBodyPose(body, X_WL[child].q, com);
    dBodySetLinearVel(body, v_com.x(), v_com.y(), v_com.z());
    dBodySetAngularVel(body, w[child].x(), w[child].y(), w[child].z());
  }
}

void OdeEnv::SetHeld(bool held) {
  held_ = held;
  // A disabled body keeps its pose; its contacts are attached to the world meanwhile.
  dBodySetLinearVel(object_body_, 0, 0, 0);
  dBodySetAngularVel(object_body_, 0, 0, 0);
  if (held)
    dBodyDisable(object_body_);
  else
    dBodyEnable(object_body_);
}

LinkPose OdeEnv::ObjectPose() const {
  const dReal* R = dBodyGetRotation(object_body_);
  const dReal* p = dBodyGetPosition(object_body_);
  LinkPose pose;
  pose.R << R[0], R[1], R[2], R[4], R[5], R[6], R[8], R[9], R[10];
  pose.p = Vector3d(p[0], p[1], p[2]) - pose.R * physics_.com;
  return pose;
}

void OdeEnv::Read(SimState& state, int row) const {
  const int joints = model_.hand.num_joints();
  for (int j = 0; j < joints; ++j) {
    state.joint_position[row * joints + j] = dJointGetHingeAngle(hinges_[j]);
    state.joint_velocity[row * joints + j] = dJointGetHingeAngleRate(hinges_[j]);
  }
  const Vector3d p = ObjectPose().p;
  const dReal* q = dBodyGetQuaternion(object_body_);
  const dReal* v = dBodyGetLinearVel(object_body_);
  const dReal* w = dBodyGetAngularVel(object_body_);
  for (int k = 0; k < 3; ++k) {
    state.object_position[3 * row + k] = p[k];
    state.object_velocity[3 * row + k] = v[k];
    state.object_spin[3 * row + k] = w[k];
  }
  for (int k = 0; k < 4; ++k) state.object_rotation[4 * row + k] = q[k];
  const std::size_t fingers = tip_contact_.size();
  std::copy(tip_contact_.begin(), tip_contact_.end(), state.tip_contact.begin() + row * fingers);
  state.contact_count[row] = contact_count_;
  state.max_penetration[row] = max_penetration_;
}

}  // namespace dexremoe
