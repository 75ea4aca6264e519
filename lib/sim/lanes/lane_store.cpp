#include "sim/lanes/lane_store.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/check.h"
#include "base/error.h"

namespace dexremoe {

using Eigen::Quaterniond;
using Eigen::Vector3d;

LaneStore::LaneStore(const LanesModel& model, int num_envs)
    : model_(model),
      blocks_((num_envs + kBlockLanes - 1) / kBlockLanes),
      rows_(static_cast<std::size_t>(blocks_) * model.layout.rows * kBlockLanes),
      object_(blocks_ * kBlockLanes, 0) {
  EnvState rest;
  rest.q.assign(model.layout.joints, 0.0);
  rest.qd = rest.q;
  rest.X_WO.p = {0, 0, 10};
  for (int slot = 0; slot < blocks_ * kBlockLanes; ++slot) {
    PutObject(slot, 0, {});
    PutState(slot, rest);
    PutHeld(slot, slot >= num_envs);
  }
}

float* LaneStore::Block(int block) {
  return rows_.data() + static_cast<std::size_t>(block) * model_.layout.rows * kBlockLanes;
}

std::size_t LaneStore::Index(int slot, int row) const {
  return (static_cast<std::size_t>(slot / kBlockLanes) * model_.layout.rows + row) * kBlockLanes +
         slot % kBlockLanes;
}

void LaneStore::PutVector(int slot, int row, const Vector3d& v) {
  for (int k = 0; k < 3; ++k) At(slot, row + k) = static_cast<float>(v[k]);
}

Vector3d LaneStore::GetVector(int slot, int row) const {
  return {At(slot, row), At(slot, row + 1), At(slot, row + 2)};
}

Quaterniond LaneStore::Rotation_WB(int slot) const {
  const int q = model_.layout.quat;
  return Quaterniond(At(slot, q), At(slot, q + 1), At(slot, q + 2), At(slot, q + 3));
}

void LaneStore::PutObject(int slot, int index, const EnvPhysics& physics) {
  const LaneObject& object = model_.objects[index];
  if (!(physics.mass > 0)) Fail("object {}: mass: expected > 0 kg, found {}", index, physics.mass);
  const BlockLayout& at = model_.layout;
  object_[slot] = index;
  const Vector3d com_B = object.q_OB.conjugate() * physics.com;
  At(slot, at.root_mass) = static_cast<float>(std::sqrt(physics.mass));
  PutVector(slot, at.root_inertia,
            physics.scale * (physics.mass * object.unit_inertia).cwiseSqrt());
  At(slot, at.friction) = static_cast<float>(physics.friction);
  At(slot, at.torsion) = static_cast<float>(physics.torsional_friction);
  PutVector(slot, at.gravity, physics.gravity);
  At(slot, at.kp) = static_cast<float>(model_.kp * physics.kp_factor);
  At(slot, at.kd) = static_cast<float>(model_.kd * physics.kd_factor);
  PutVector(slot, at.com, com_B);
  At(slot, at.reach) = static_cast<float>(object.radius * physics.scale);
  PutVector(slot, at.box, physics.scale * object.box.Center());
  PutVector(slot, at.box + 3, 0.5 * physics.scale * object.box.Size());
  At(slot, at.field) = std::bit_cast<float>(object.first_node);
  PutVector(slot, at.field_scale, (physics.scale * object.spacing).cwiseInverse());
  PutVector(slot, at.field_shift, -object.origin.cwiseQuotient(object.spacing));
  At(slot, at.field_unit) = static_cast<float>(object.quantum * physics.scale);
}

void LaneStore::PutState(int slot, const EnvState& state) {
  const BlockLayout& at = model_.layout;
  for (int j = 0; j < at.joints; ++j) {
    At(slot, at.q + j) = static_cast<float>(state.q[model_.joint_of[j]]);
    At(slot, at.qd + j) = static_cast<float>(state.qd[model_.joint_of[j]]);
  }
  const Quaterniond q_WB = state.X_WO.q * model_.objects[object_[slot]].q_OB;
  PutVector(slot, at.x, state.X_WO.p + q_WB * GetVector(slot, at.com));
  const double q[4] = {q_WB.w(), q_WB.x(), q_WB.y(), q_WB.z()};
  for (int k = 0; k < 4; ++k) At(slot, at.quat + k) = static_cast<float>(q[k]);
  PutVector(slot, at.v, state.v);
  PutVector(slot, at.w, state.w);
  PutVector(slot, at.push, Vector3d::Zero());
  ForgetContacts(slot);
}

void LaneStore::ForgetContacts(int slot) {
  const BlockLayout& at = model_.layout;
  for (int group = 0; group <= at.chains; ++group)
    for (int k = 0; k < kSlots; ++k) At(slot, at.Contact(group, k)) = -1;
  for (int row = at.inset; row < at.touch; ++row) At(slot, row) = 0;
  for (int c = 0; c < at.chains; ++c) At(slot, at.touch + c) = 0;
  At(slot, at.points) = At(slot, at.depth) = 0;
}

void LaneStore::PutHeld(int slot, bool held) {
  const BlockLayout& at = model_.layout;
  At(slot, at.free) = held ? 0.0f : 1.0f;
  PutVector(slot, at.v, Vector3d::Zero());
  PutVector(slot, at.w, Vector3d::Zero());
}

void LaneStore::PutPush(int slot, const Vector3d& force) {
  PutVector(slot, model_.layout.push, force);
}

void LaneStore::PutTargets(int slot, const double* targets) {
  const BlockLayout& at = model_.layout;
  for (int j = 0; j < at.joints; ++j)
    At(slot, at.target + j) = static_cast<float>(targets[model_.joint_of[j]]);
}

void LaneStore::Read(int slot, int env, SimState& state) const {
  const BlockLayout& at = model_.layout;
  const std::size_t row = env;
  for (int j = 0; j < at.joints; ++j) {
    state.joint_position[row * at.joints + model_.joint_of[j]] = At(slot, at.q + j);
    state.joint_velocity[row * at.joints + model_.joint_of[j]] = At(slot, at.qd + j);
  }
  const LaneObject& object = model_.objects[object_[slot]];
  Quaterniond q = Rotation_WB(slot);
  const Vector3d com = GetVector(slot, at.com);
  Vector3d p = GetVector(slot, at.x);
  if (!com.isZero(0)) p -= q.toRotationMatrix() * com;
  if (object.turned) q = q * object.q_OB.conjugate();
  for (int k = 0; k < 3; ++k) {
    state.object_position[3 * row + k] = p[k];
    state.object_velocity[3 * row + k] = At(slot, at.v + k);
    state.object_spin[3 * row + k] = At(slot, at.w + k);
  }
  const double wxyz[4] = {q.w(), q.x(), q.y(), q.z()};
  std::copy(wxyz, wxyz + 4, &state.object_rotation[4 * row]);
  for (int c = 0; c < at.chains; ++c)
    state.tip_contact[row * at.chains + c] = At(slot, at.touch + c) > 0;
  state.contact_count[row] = static_cast<int>(At(slot, at.points));
  state.max_penetration[row] = At(slot, at.depth);
}

void LaneStore::Prefetch(int block) const {
  const std::size_t size = static_cast<std::size_t>(model_.layout.rows) * kBlockLanes;
  const float* rows = rows_.data() + block * size;
  for (std::size_t i = 0; i < size; i += kBlockLanes) __builtin_prefetch(rows + i, 1, 2);
}

bool LaneStore::AllFinite(int block) const {
  const BlockLayout& at = model_.layout;
  const float* rows = rows_.data() + static_cast<std::size_t>(block) * at.rows * kBlockLanes;
  float sums[kBlockLanes] = {};  // of zeros, or not a number
  for (int row = at.q; row < at.push; ++row)
    for (int lane = 0; lane < kBlockLanes; ++lane) sums[lane] += 0 * rows[row * kBlockLanes + lane];
  return std::all_of(sums, sums + kBlockLanes, [](float sum) { return sum == 0; });
}

std::vector<float> LaneStore::Numbers(int slot) const {
  std::vector<float> numbers(model_.layout.rows);
  for (int row = 0; row < model_.layout.rows; ++row) numbers[row] = At(slot, row);
  return numbers;
}

void LaneStore::PutNumbers(int slot, int object, std::span<const float> numbers) {
  if (static_cast<int>(numbers.size()) != model_.layout.rows)
    Fail("saved state: numbers: expected {}, found {}", model_.layout.rows, numbers.size());
  object_[slot] = object;
  for (int row = 0; row < model_.layout.rows; ++row) At(slot, row) = numbers[row];
}

void LaneStore::Reorder(std::span<const int> order) {
  BigArray<float> old(rows_.size());
  std::copy_n(rows_.data(), rows_.size(), old.data());
  const std::vector<int> objects = object_;
  for (std::size_t slot = 0; slot < order.size(); ++slot) {
    for (int row = 0; row < model_.layout.rows; ++row)
      At(static_cast<int>(slot), row) = old[Index(order[slot], row)];
    object_[slot] = objects[order[slot]];
  }
}

}  // namespace dexremoe
