// Contact joints of one substep, and friction bounds from the forces of the one before.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "sim/ode/ode_env.h"

namespace dexremoe {
namespace {

using Eigen::Vector3d;

// Contacts are looked for this far ahead, and as far as hand and object move in a step. A point
// with a gap may close it within the step but not go deeper, so nothing tunnels and resting
// contacts stay at the skin.
constexpr double kMargin = 2e-3;  // m
// Thickness that contacts keep between the surfaces: the exact distance algorithm then sees
// separate cores, and the overlap one is left to the rare deep contact.
constexpr double kSkin = 1e-4;  // m
// Share of an overlap that is corrected in a step, and the fastest correction.
constexpr double kContactErp = 0.2;
constexpr double kMaxCorrection = 1.0;  // m/s
// Softness of contact rows, (m/s) / N. It keeps redundant contacts solvable; friction creeps by
// 1e-6 m/s for each N.
constexpr double kContactCfm = 1e-5;
constexpr double kFrictionCfm = 1e-6;
constexpr double kSpinCfm = 1e-2;  // (rad/s) / (N m)
constexpr double kLeastFriction = 1e-5;
// A point inherits the force of an old one this near on the same collider.
constexpr double kSameContact = 8e-3;  // m
// What forces may close beyond the present speed: 14 m/s^2 over a step of 1/120 s. With less,
// grasps and survival under random targets suffer (0.5 mm: 177 of 200 hold at one substep, not
// 184).
constexpr double kReach = 1e-3;        // m
constexpr double kNoForce = 1e-4;      // N
constexpr double kVisibleSlip = 2e-3;  // m/s

Vector3d ToVector(const dReal* v) { return {v[0], v[1], v[2]}; }
Vector3d ToVector(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }
std::array<double, 3> ToArray(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Vector3d PointVelocity(dBodyID body, const Vector3d& point) {
  if (body == nullptr) return Vector3d::Zero();
  const Vector3d arm = point - ToVector(dBodyGetPosition(body));
  return ToVector(dBodyGetLinearVel(body)) + ToVector(dBodyGetAngularVel(body)).cross(arm);
}

// Normal velocity that the contact asks for at the end of a step of length h.
double SeparationSpeed(double gap, double h) {
  if (gap > 0) return -gap / h;
  return std::min(-gap * kContactErp / h, kMaxCorrection);
}

dContact MakeContact(const ContactPoint& point, double h) {
  dContact contact = {};
  contact.surface.mode = dContactMotionN | dContactSoftCFM;
  contact.surface.motionN = SeparationSpeed(point.gap - kSkin, h);
  contact.surface.soft_cfm = kContactCfm;
  for (int k = 0; k < 3; ++k) {
    contact.geom.pos[k] = point.position[k];
    contact.geom.normal[k] = point.normal[k];
  }
  return contact;
}

}  // namespace

dBodyID OdeEnv::BodyOf(int collider) const {
  const int link = model_.contacts.hand[collider].link;
  return link == 0 ? nullptr : links_[link - 1];
}

// Velocity of the object against the hand at a contact, tangential part.
Vector3d OdeEnv::SlipVelocity(const ContactPoint& point) const {
  const Vector3d v = RelativeVelocity(point);
  return v - v.dot(point.normal) * point.normal;
}

Vector3d OdeEnv::RelativeVelocity(const ContactPoint& point) const {
  return PointVelocity(object_body_, point.position) -
         PointVelocity(BodyOf(point.collider), point.position);
}

// A bound, up to the rotation of links, of how fast hand and object can come closer.
double OdeEnv::FastestApproach() const {
  double link_speed = 0;
  for (const dBodyID link : links_)
    link_speed = std::max(link_speed, ToVector(dBodyGetLinearVel(link)).norm());
  return link_speed + ToVector(dBodyGetLinearVel(object_body_)).norm() +
         ToVector(dBodyGetAngularVel(object_body_)).norm() *
             model_.contacts.objects[object_].radius * physics_.scale;
}

void OdeEnv::CreateContacts(ContactFinder& finder, double h) {
  active_.clear();
  const double margin = kMargin + h * FastestApproach();
  for (const ContactPoint& point : finder.ObjectContacts(
           poses_, object_, physics_.scale, ObjectPose(), margin, model_.options.max_contacts))
    // Points that cannot close within the step are left out.
    if (point.gap - kSkin + h * RelativeVelocity(point).dot(point.normal) < kReach)
      active_.push_back({point, {}, {}});
  InheritForces();
  for (ActiveContact& contact : active_) CreateObjectContact(contact, h);
  for (const ContactPoint& point : finder.SelfContacts(poses_, kMargin))
    CreateSelfContact(point, h);
}

// Every old force goes to the nearest new point of its collider, so that their sum is kept.
void OdeEnv::InheritForces() {
  for (const ContactForce& old : forces_) {
    const LinkPose& X_WL = poses_[model_.contacts.hand[old.collider].link];
    const Vector3d spot = X_WL.R * ToVector(old.local) + X_WL.p;
    ActiveContact* nearest = nullptr;
    double least = kSameContact * kSameContact;
    for (ActiveContact& contact : active_) {
      if (contact.point.collider != old.collider) continue;
      const double distance2 = (contact.point.position - spot).squaredNorm();
      if (distance2 >= least) continue;
      least = distance2;
      nearest = &contact;
    }
    if (nearest == nullptr) continue;
    nearest->inherited.normal += old.normal;
    for (int k = 0; k < 3; ++k) nearest->inherited.friction[k] += old.friction[k];
  }
}

// The direction that friction on this contact works along: against a visible slip, else that of
// the force of its collider's contacts together in the last substep. One direction for all points
// of a face: their own forces hold each other's redundant shares besides the load.
Vector3d OdeEnv::FrictionDirection(const ActiveContact& contact) const {
  const Vector3d& normal = contact.point.normal;
  Vector3d along = SlipVelocity(contact.point);
  if (along.squaredNorm() < kVisibleSlip * kVisibleSlip) {
    along.setZero();
    for (const ActiveContact& other : active_)
      if (other.point.collider == contact.point.collider)
        along += ToVector(other.inherited.friction);
    if (along.norm() < kNoForce) return Vector3d::Zero();
  }
  along -= along.dot(normal) * normal;
  const double length = along.norm();
  return length > 0 ? Vector3d(along / length) : Vector3d::Zero();
}

// Coulomb's law couples friction bounds and normal forces, which the stepper cannot. Its own way
// out (dContactApprox1) takes the normal forces of the frictionless problem, and the pyramid of its
// bounds holds 41 % too much along the diagonal. We bound friction by mu times the normal force of
// the substep before, along the direction friction works in, and leave the stepper's way to new
// contacts. Measured: slip angles within 1 % of atan(mu) in every direction at two substeps, 92 %
// of closed grasps hold against 81
// %.
void OdeEnv::SetFriction(const ActiveContact& contact, dContact& joint) const {
  joint.surface.mode |= dContactSlip1 | dContactSlip2;
  joint.surface.slip1 = joint.surface.slip2 = kFrictionCfm;
  joint.surface.mu = physics_.friction;
  if (contact.inherited.normal > kNoForce)
    joint.surface.mu *= contact.inherited.normal;
  else
    joint.surface.mode |= dContactApprox1;
  const Vector3d along = FrictionDirection(contact);
  if (along.isZero()) return;
  joint.surface.mode |= dContactFDir1;
  for (int k = 0; k < 3; ++k) joint.fdir1[k] = along[k];
}

// Soft fingers: a motor that stops the object's spin about the normal, as far as the forces of the
// substep before allow; a new contact has none yet. (ODE's own rolling friction brings rows for
// both tangents too, and no softness, which the parallel rows of a face need.)
void OdeEnv::ResistSpin(const ActiveContact& contact) {
  const double force = contact.inherited.normal;
  const double slide = ToVector(contact.inherited.friction).norm();
  const double used = slide / std::max(physics_.friction, kLeastFriction);
  const double most =
      physics_.torsional_friction * std::sqrt(std::max(force * force - used * used, 0.0));
  if (!(most > 0)) return;
  const Vector3d& normal = contact.point.normal;
  const dJointID motor = dJointCreateAMotor(world_, arena_.contact_joints());
  dJointAttach(motor, held_ ? nullptr : object_body_, BodyOf(contact.point.collider));
  dJointSetAMotorMode(motor, dAMotorUser);
  dJointSetAMotorNumAxes(motor, 1);
  dJointSetAMotorAxis(motor, 0, 0, normal.x(), normal.y(), normal.z());
  dJointSetAMotorParam(motor, dParamVel, 0);
  dJointSetAMotorParam(motor, dParamFMax, most);
  dJointSetAMotorParam(motor, dParamCFM, kSpinCfm);
}

void OdeEnv::CreateObjectContact(ActiveContact& contact, double h) {
  const dBodyID tail = BodyOf(contact.point.collider);
  contact.feedback = {};
  if (held_ && tail == nullptr) return;
  dContact joint = MakeContact(contact.point, h);
  SetFriction(contact, joint);
  const dJointID id = dJointCreateContact(world_, arena_.contact_joints(), &joint);
  dJointAttach(id, held_ ? nullptr : object_body_, tail);
  dJointSetFeedback(id, &contact.feedback);
  ResistSpin(contact);
}

// Fingers only keep apart from each other: one row a point, no friction.
void OdeEnv::CreateSelfContact(const ContactPoint& point, double h) {
  const dContact joint = MakeContact(point, h);
  const dJointID id = dJointCreateContact(world_, arena_.contact_joints(), &joint);
  dJointAttach(id, BodyOf(point.other), BodyOf(point.collider));
}

void OdeEnv::CollectForces() {
  forces_.clear();
  std::fill(tip_contact_.begin(), tip_contact_.end(), 0);
  contact_count_ = 0;
  max_penetration_ = 0;
  for (const ActiveContact& contact : active_) {
    const ContactPoint& point = contact.point;
    max_penetration_ = std::max(max_penetration_, -point.gap);
    // On the object; while it is held the joint's first body is the link.
    const Vector3d force = (held_ ? -1.0 : 1.0) * ToVector(contact.feedback.f1);
    const double normal = force.dot(point.normal);
    if (normal <= kNoForce) continue;
    ++contact_count_;
    const Collider& collider = model_.hand.colliders[point.collider];
    if (collider.fingertip) tip_contact_[model_.hand.links[collider.link].chain] = 1;
    const LinkPose& X_WL = poses_[collider.link];
    forces_.push_back({point.collider, ToArray(X_WL.R.transpose() * (point.position - X_WL.p)),
                       normal, ToArray(force - normal * point.normal)});
  }
}

}  // namespace dexremoe
