// One environment: an ODE world with the hand's links, their joints and servos, and the object.
//
// Link i of the hand (i >= 1) is body i - 1, its frame at the link's centre of mass with the axes
// of the link frame. The base is the world. All geometry is ours (sim/ode/contacts.h).
#pragma once

#include <ode/ode.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "sim/batch_sim.h"
#include "sim/ode/contacts.h"
#include "sim/ode/ode_runtime.h"

namespace dexremoe {

// Constants of a run, shared by all environments.
struct OdeModel {
  SimOptions options;
  HandModel hand;
  std::vector<SimObject> objects;
  ContactModel contacts;
};

// Plain numbers of one contact of the last substep, to bound the friction of the next one.
struct ContactForce {
  std::int64_t collider = 0;
  std::array<double, 3> local{};     // contact point in the link frame; m
  double normal = 0;                 // N
  std::array<double, 3> friction{};  // on the object, W; N
};

class OdeEnv {
 public:
  OdeEnv(const OdeModel& model, OdeArena& arena);
  ~OdeEnv();
  OdeEnv(const OdeEnv&) = delete;
  OdeEnv& operator=(const OdeEnv&) = delete;

  void SetObject(int object, const EnvPhysics& physics);
  void SetState(const EnvState& state);
  void SetHeld(bool held);
  void Push(const Eigen::Vector3d& force) { push_ = {force.x(), force.y(), force.z()}; }
  void Save(ByteWriter& out) const;
  void Restore(ByteReader& in);

  // One control step: options.substeps steps of the world. targets [num_joints], rad.
  void Step(const double* targets, ContactFinder& finder);
  // Control steps since SetState.
  std::int64_t steps() const { return steps_; }
  // Copies the state into row `row` of the arrays; columns as in SimState.
  void Read(SimState& state, int row) const;

 private:
  struct ActiveContact {
    ContactPoint point;
    ContactForce inherited;  // sums of normal and friction; the rest unused
    dJointFeedback feedback;
  };

  void CreateBodies();
  void CreateJoints();
  void SetObjectMass();
  void SetBodyPose(dBodyID body, const Eigen::Quaterniond& q, const Eigen::Vector3d& p);
  void SetLinkStates(const EnvState& state);

  void Substep(const double* targets, double h, ContactFinder& finder);
  void UpdateLinkPoses();
  void SetServo(int j, double target, double h);
  void SetRow(int j, int row, double speed, double stiffness, double limit);
  void CreateContacts(ContactFinder& finder, double h);
  double FastestApproach() const;
  void InheritForces();
  dBodyID BodyOf(int collider) const;
  Eigen::Vector3d RelativeVelocity(const ContactPoint& point) const;
  Eigen::Vector3d SlipVelocity(const ContactPoint& point) const;
  Eigen::Vector3d FrictionDirection(const ActiveContact& contact) const;
  void SetFriction(const ActiveContact& contact, dContact& joint) const;
  void ResistSpin(const ActiveContact& contact);
  void CreateObjectContact(ActiveContact& contact, double h);
  void CreateSelfContact(const ContactPoint& point, double h);
  void CollectForces();
  LinkPose ObjectPose() const;

  const OdeModel& model_;
  OdeArena& arena_;
  dWorldID world_;
  dBodyID object_body_;
  std::vector<dBodyID> links_;    // [J]
  std::vector<dJointID> hinges_;  // [J]
  std::vector<dJointID> servos_;  // [J]

  // State besides the bodies'.
  std::int64_t steps_ = 0;
  int object_ = 0;
  EnvPhysics physics_;
  bool held_ = false;
  std::array<double, 3> push_{};
  std::vector<ContactForce> forces_;       // of the last substep
  std::vector<std::uint8_t> tip_contact_;  // [F]
  int contact_count_ = 0;
  double max_penetration_ = 0;

  // Scratch of one substep.
  std::vector<LinkPose> poses_;  // [L], base first
  std::vector<ActiveContact> active_;
};

}  // namespace dexremoe
