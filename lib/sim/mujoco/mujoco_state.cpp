// The whole state of an environment as bytes, bit for bit.
#if __has_include(<mujoco/mujoco.h>)
#include "base/error.h"
#include "sim/mujoco/mujoco_env.h"

namespace dexremoe {
namespace {

using PhysicsNumbers = std::array<double, 11>;

PhysicsNumbers NumbersOf(const EnvPhysics& p) {
  return {p.mass,      p.com.x(),   p.com.y(),     p.com.z(),     p.friction,   p.scale,
          p.kp_factor, p.kd_factor, p.gravity.x(), p.gravity.y(), p.gravity.z()};
}

EnvPhysics PhysicsOf(const PhysicsNumbers& n) {
  EnvPhysics physics;
  physics.mass = n[0];
  physics.com = {n[1], n[2], n[3]};
  physics.friction = n[4];
  physics.scale = n[5];
  physics.kp_factor = n[6];
  physics.kd_factor = n[7];
  physics.gravity = {n[8], n[9], n[10]};
  return physics;
}

template <typename T>
void ReadSized(ByteReader& in, std::vector<T>& values, const char* field) {
  std::vector<T> found = in.GetVector<T>();
  if (found.size() != values.size())
    Fail("saved state: {}: expected {} numbers, found {}", field, values.size(), found.size());
  values = std::move(found);
}

}  // namespace

void MujocoEnv::Save(ByteWriter& out) const {
  out.Put(steps_);
  out.Put(static_cast<std::int64_t>(object_));
  out.Put(NumbersOf(physics_));
  out.PutVector(position_);
  out.PutVector(velocity_);
  out.PutVector(warm_);
  out.Put(static_cast<std::int64_t>(held_));
  out.Put(push_);
  out.PutVector(tip_contact_);
  out.Put(static_cast<std::int64_t>(contact_count_));
  out.Put(max_penetration_);
}

void MujocoEnv::Restore(ByteReader& in) {
  in.GetInto(steps_);
  const auto object = in.Get<std::int64_t>();
  const auto count = static_cast<std::int64_t>(scene_.objects().size());
  if (object < 0 || object >= count)
    Fail("saved state: object: expected 0..{}, found {}", count - 1, object);
  SetObject(static_cast<int>(object), PhysicsOf(in.Get<PhysicsNumbers>()));
  ReadSized(in, position_, "position");
  ReadSized(in, velocity_, "velocity");
  ReadSized(in, warm_, "acceleration");
  held_ = in.Get<std::int64_t>() != 0;
  in.GetInto(push_);
  ReadSized(in, tip_contact_, "tip_contact");
  contact_count_ = static_cast<int>(in.Get<std::int64_t>());
  in.GetInto(max_penetration_);
}

}  // namespace dexremoe
#endif
