// The whole state of an environment as bytes, bit for bit.
#include <algorithm>

#include "base/error.h"
#include "sim/ode/ode_env.h"
#include "sim/sim_shared.h"

namespace dexremoe {
namespace {

using BodyState = std::array<double, 3 + 4 + 12 + 3 + 3>;  // position, quaternion, R, v, w

BodyState StateOf(dBodyID body) {
  BodyState state;
  double* at = state.data();
  at = std::copy_n(dBodyGetPosition(body), 3, at);
  at = std::copy_n(dBodyGetQuaternion(body), 4, at);
  at = std::copy_n(dBodyGetRotation(body), 12, at);
  at = std::copy_n(dBodyGetLinearVel(body), 3, at);
  std::copy_n(dBodyGetAngularVel(body), 3, at);
  return state;
}

// dBodySetQuaternion normalises what it gets, which can change the last bit of a quaternion that
// came out of a step. The bodies carry no ODE geometry, so nothing hangs on the setters and the
// numbers may be put in their place directly.
void PutState(dBodyID body, const BodyState& state) {
  const double* at = state.data();
  std::copy_n(at, 3, const_cast<dReal*>(dBodyGetPosition(body)));
  std::copy_n(at + 3, 4, const_cast<dReal*>(dBodyGetQuaternion(body)));
  std::copy_n(at + 7, 12, const_cast<dReal*>(dBodyGetRotation(body)));
  dBodySetLinearVel(body, at[19], at[20], at[21]);
  dBodySetAngularVel(body, at[22], at[23], at[24]);
}

}  // namespace

void OdeEnv::Save(ByteWriter& out) const {
  out.Put(steps_);
  out.Put(static_cast<std::int64_t>(object_));
  out.Put(NumbersOf(physics_));
  out.Put(static_cast<std::uint64_t>(links_.size()));
  for (const dBodyID link : links_) out.Put(StateOf(link));
  out.Put(StateOf(object_body_));
  out.Put(static_cast<std::int64_t>(held_));
  out.Put(push_);
  out.PutVector(forces_);
  out.PutVector(tip_contact_);
  out.Put(static_cast<std::int64_t>(contact_count_));
  out.Put(max_penetration_);
}

void OdeEnv::Restore(ByteReader& in) {
  in.GetInto(steps_);
  const auto object = in.Get<std::int64_t>();
  if (object < 0 || object >= static_cast<std::int64_t>(model_.objects.size()))
    Fail("saved state: object: expected 0..{}, found {}", model_.objects.size() - 1, object);
  const auto physics = in.Get<PhysicsNumbers>();
  const auto links = in.Get<std::uint64_t>();
  if (links != links_.size())
    Fail("saved state: links: expected {}, found {}", links_.size(), links);
  SetObject(static_cast<int>(object), PhysicsOf(physics));
  for (const dBodyID link : links_) PutState(link, in.Get<BodyState>());
  const auto body = in.Get<BodyState>();
  SetHeld(in.Get<std::int64_t>() != 0);  // zeroes the velocities
  PutState(object_body_, body);
  in.GetInto(push_);
  forces_ = in.GetVector<ContactForce>();
  tip_contact_ = in.GetVector<std::uint8_t>();
  if (tip_contact_.size() != model_.hand.chains.size())
    Fail("saved state: tip_contact: expected {} fingers, found {}", model_.hand.chains.size(),
         tip_contact_.size());
  contact_count_ = static_cast<int>(in.Get<std::int64_t>());
  in.GetInto(max_penetration_);
}

}  // namespace dexremoe
