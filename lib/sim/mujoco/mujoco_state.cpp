// The whole state of an environment as bytes, bit for bit.
#if __has_include(<mujoco/mujoco.h>)
#include "base/error.h"
#include "sim/mujoco/mujoco_env.h"
#include "sim/sim_shared.h"

namespace dexremoe {
namespace {

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
