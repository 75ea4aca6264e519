#include "sim/lanes/lanes_sim.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <memory>
#include <numeric>
#include <utility>

#include "base/bytes.h"
#include "base/check.h"
#include "base/error.h"
#include "sim/lanes/big_array.h"
#include "sim/lanes/lanes_kernel.h"
#include "sim/lanes/object_field.h"
#include "sim/sim_rows.h"

namespace dexremoe {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

LanesKernel ChooseKernel(const std::string& instructions) {
  const std::vector<LanesKernel> kernels = LanesKernels();
  if (instructions == "auto") return kernels.front();
  for (const LanesKernel& kernel : kernels)
    if (kernel.name == instructions) return kernel;
  Fail("sim.instructions: this processor has no {}; its fastest is {}", instructions,
       kernels.front().name);
}

class LanesSim : public BatchSim {
 public:
  LanesSim(const SimOptions& options, const HandModel& hand, const std::vector<SimObject>& objects,
           int num_envs, ThreadPool& pool)
      : model_(MakeLanesModel(options, hand, objects, pool)),
        kernel_(ChooseKernel(options.instructions)),
        pool_(pool),
        num_envs_(num_envs),
        blocks_((num_envs + kBlockLanes - 1) / kBlockLanes),
        rows_(static_cast<std::size_t>(blocks_) * model_.layout.rows * kBlockLanes),
        slot_(num_envs),
        object_(blocks_ * kBlockLanes, 0),
        steps_(num_envs, 0),
        state_(SizedState(num_envs, hand)) {
    std::iota(slot_.begin(), slot_.end(), 0);
    // Lanes without an environment hold one too: they are computed with the rest.
    for (int slot = 0; slot < blocks_ * kBlockLanes; ++slot) PutObject(slot, 0, {});
    for (int slot = 0; slot < blocks_ * kBlockLanes; ++slot) PutRest(slot);
    for (int env = 0; env < num_envs; ++env) Read(env);
  }

  int num_envs() const override { return num_envs_; }
  int num_joints() const override { return model_.layout.joints; }
  const SimState& state() const override { return state_; }

  void SetObject(int env, int object, const EnvPhysics& physics) override {
    CheckObject(env, object, model_.objects.size());
    grouped_ = grouped_ && object_[Slot(env)] == object;
    PutObject(Slot(env), object, physics);
  }

  void SetState(int env, const EnvState& state) override {
    CheckStateToSet(env, state, num_joints());
    PutState(Slot(env), state);
    steps_[env] = 0;
    Read(env);
  }

  std::vector<std::uint8_t> Save(int env) const override {
    ByteWriter out;
    out.Put(steps_[env]);
    out.Put(static_cast<std::int64_t>(object_[Slot(env)]));
    std::vector<float> numbers(model_.layout.rows);
    for (int row = 0; row < model_.layout.rows; ++row) numbers[row] = At(Slot(env), row);
    out.PutVector(numbers);
    return out.Take();
  }

  void Restore(int env, std::span<const std::uint8_t> bytes) override {
    ByteReader in(bytes);
    const auto steps = in.Get<std::int64_t>();
    const auto object = in.Get<std::int64_t>();
    const std::vector<float> numbers = in.GetVector<float>();
    in.Finish();
    CheckObject(env, static_cast<int>(object), model_.objects.size());
    if (static_cast<int>(numbers.size()) != model_.layout.rows)
      Fail("saved state: numbers: expected {}, found {}", model_.layout.rows, numbers.size());
    steps_[env] = steps;
    grouped_ = grouped_ && object_[Slot(env)] == object;
    object_[Slot(env)] = static_cast<int>(object);
    for (int row = 0; row < model_.layout.rows; ++row) At(Slot(env), row) = numbers[row];
    Read(env);
  }

  void SetHeld(int env, bool held) override {
    const BlockLayout& at = model_.layout;
    At(Slot(env), at.free) = held ? 0.0f : 1.0f;
    for (int k = 0; k < 3; ++k) At(Slot(env), at.v + k) = At(Slot(env), at.w + k) = 0;
  }

  void PushObject(int env, const Vector3d& force) override {
    PutVector(Slot(env), model_.layout.push, force);
  }

  void Step(std::span<const double> targets, std::span<const std::uint8_t> active) override {
    CheckTargets(targets, active, *this, steps_);
    if (!grouped_) Regroup();
    std::vector<PhaseTicks> ticks(profiling_ ? pool_.workers() : 0, PhaseTicks{});
    pool_.ParallelFor(blocks_, [&](int block, int worker) {
      StepOne(block, targets, active, profiling_ ? &ticks[worker] : nullptr);
    });
    for (const PhaseTicks& worker : ticks)
      for (int phase = 0; phase < kPhases; ++phase) ticks_[phase] += worker[phase];
  }

  LanesFootprint Footprint() const {
    return {model_.layout.rows * sizeof(float), kFieldSize * sizeof(std::int16_t), kBlockLanes,
            kernel_.name};
  }
  void StartProfile() {
    profiling_ = true;
    ticks_ = {};
  }
  LanesProfile StopProfile() {
    profiling_ = false;
    LanesProfile profile;
    profile.phases = {"kinematics and dynamics", "distance field", "contact set-up", "solver",
                      "finish"};
    const double sum = std::accumulate(ticks_.begin(), ticks_.end(), 0.0);
    for (const std::uint64_t ticks : ticks_) profile.shares.push_back(ticks / std::max(sum, 1.0));
    return profile;
  }

 private:
  int Slot(int env) const {
    DEX_CHECK_GE(env, 0);
    DEX_CHECK_LT(env, num_envs_);
    return slot_[env];
  }

  float* Block(int block) {
    return rows_.data() + static_cast<std::size_t>(block) * model_.layout.rows * kBlockLanes;
  }
  std::size_t Index(int slot, int row) const {
    return (static_cast<std::size_t>(slot / kBlockLanes) * model_.layout.rows + row) * kBlockLanes +
           slot % kBlockLanes;
  }
  float& At(int slot, int row) { return rows_[Index(slot, row)]; }
  float At(int slot, int row) const { return rows_[Index(slot, row)]; }

  void PutVector(int slot, int row, const Vector3d& v) {
    for (int k = 0; k < 3; ++k) At(slot, row + k) = static_cast<float>(v[k]);
  }
  Vector3d GetVector(int slot, int row) const {
    return {At(slot, row), At(slot, row + 1), At(slot, row + 2)};
  }
  Quaterniond Rotation_WB(int slot) const {
    const int q = model_.layout.quat;
    return Quaterniond(At(slot, q), At(slot, q + 1), At(slot, q + 2), At(slot, q + 3));
  }
  void PutObject(int slot, int index, const EnvPhysics& physics) {
    const LaneObject& object = model_.objects[index];
    if (!(physics.mass > 0)) Fail("object mass: expected > 0 kg, found {}", physics.mass);
    const BlockLayout& at = model_.layout;
    object_[slot] = index;
    const Vector3d com_B = object.q_OB.conjugate() * physics.com;
    At(slot, at.root_mass) = static_cast<float>(std::sqrt(physics.mass));
    PutVector(slot, at.root_inertia,
              physics.scale * (physics.mass * object.unit_inertia).cwiseSqrt());
    At(slot, at.friction) = static_cast<float>(physics.friction);
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

  void PutState(int slot, const EnvState& state) {
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

  void ForgetContacts(int slot) {
    const BlockLayout& at = model_.layout;
    for (int group = 0; group <= at.chains; ++group)
      for (int k = 0; k < kSlots; ++k) At(slot, at.Contact(group, k)) = -1;
    for (int row = at.inset; row < at.touch; ++row) At(slot, row) = 0;
    for (int c = 0; c < at.chains; ++c) At(slot, at.touch + c) = 0;
    At(slot, at.points) = At(slot, at.depth) = 0;
  }

  // A state for lanes that nobody set: the object far below the hand.
  void PutRest(int slot) {
    EnvState state;
    state.q.assign(num_joints(), 0.0);
    state.qd = state.q;
    state.X_WO.p = {0, 0, 10};
    PutState(slot, state);
    At(slot, model_.layout.free) = slot < num_envs_ ? 1.0f : 0.0f;
  }

  // Sorts environments by object, so that the fields a worker reads stay in its cache.
  void Regroup() {
    std::vector<int> order(num_envs_), env_of(num_envs_);
    for (int env = 0; env < num_envs_; ++env) env_of[slot_[env]] = env;
    std::iota(order.begin(), order.end(), 0);  // slots
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return object_[a] < object_[b]; });
    BigArray<float> old(rows_.size());
    std::copy_n(rows_.data(), rows_.size(), old.data());
    const std::vector<int> objects = object_;
    for (int slot = 0; slot < num_envs_; ++slot) {
      for (int row = 0; row < model_.layout.rows; ++row)
        At(slot, row) = old[Index(order[slot], row)];
      object_[slot] = objects[order[slot]];
      slot_[env_of[order[slot]]] = slot;
    }
    env_of_slot_.resize(num_envs_);
    for (int env = 0; env < num_envs_; ++env) env_of_slot_[slot_[env]] = env;
    grouped_ = true;
  }

  void StepOne(int block, std::span<const double> targets, std::span<const std::uint8_t> active,
               PhaseTicks* ticks) {
    const BlockLayout& at = model_.layout;
    const int first = block * kBlockLanes, last = std::min(first + kBlockLanes, num_envs_);
    bool all = true, any = false;
    for (int slot = first; slot < last; ++slot) {
      const bool moves = active.empty() || active[env_of_slot_[slot]];
      all = all && moves;
      any = any || moves;
    }
    if (!any) return;
    const std::size_t size = static_cast<std::size_t>(at.rows) * kBlockLanes;
    std::vector<float> before;
    if (!all) before.assign(Block(block), Block(block) + size);
    for (int slot = first; slot < last; ++slot) {
      const double* target = &targets[static_cast<std::size_t>(env_of_slot_[slot]) * at.joints];
      for (int j = 0; j < at.joints; ++j)
        At(slot, at.target + j) = static_cast<float>(target[model_.joint_of[j]]);
    }
    kernel_.step(model_, Block(block), ticks);
    for (int slot = first; slot < last; ++slot) {
      const int env = env_of_slot_[slot];
      if (!all && !active[env]) {
        for (int row = 0; row < at.rows; ++row)
          At(slot, row) = before[row * kBlockLanes + slot % kBlockLanes];
        continue;
      }
      Read(env);
      CheckRow(state_, env, steps_[env]);
      ++steps_[env];
    }
  }

  // Copies the state of env into its row of the arrays.
  void Read(int env) {
    const BlockLayout& at = model_.layout;
    const int slot = slot_[env];
    const std::size_t row = env;
    for (int j = 0; j < at.joints; ++j) {
      state_.joint_position[row * at.joints + model_.joint_of[j]] = At(slot, at.q + j);
      state_.joint_velocity[row * at.joints + model_.joint_of[j]] = At(slot, at.qd + j);
    }
    const LaneObject& object = model_.objects[object_[slot]];
    Quaterniond q = Rotation_WB(slot);
    const Vector3d com = GetVector(slot, at.com);
    Vector3d p = GetVector(slot, at.x);
    if (!com.isZero(0)) p -= q.toRotationMatrix() * com;
    if (object.turned) q = q * object.q_OB.conjugate();
    for (int k = 0; k < 3; ++k) {
      state_.object_position[3 * row + k] = p[k];
      state_.object_velocity[3 * row + k] = At(slot, at.v + k);
      state_.object_spin[3 * row + k] = At(slot, at.w + k);
    }
    const double wxyz[4] = {q.w(), q.x(), q.y(), q.z()};
    std::copy(wxyz, wxyz + 4, &state_.object_rotation[4 * row]);
    for (int c = 0; c < at.chains; ++c)
      state_.tip_contact[row * at.chains + c] = At(slot, at.touch + c) > 0;
    state_.contact_count[row] = static_cast<int>(At(slot, at.points));
    state_.max_penetration[row] = At(slot, at.depth);
  }

  LanesModel model_;
  LanesKernel kernel_;
  ThreadPool& pool_;
  int num_envs_, blocks_;
  BigArray<float> rows_;             // [blocks][layout.rows][kBlockLanes]
  std::vector<int> slot_;            // [N] where each environment is: block and lane
  std::vector<int> env_of_slot_;     // [N] and back, once grouped
  std::vector<int> object_;          // [blocks * kBlockLanes], by slot
  std::vector<std::int64_t> steps_;  // [N] control steps since SetState
  bool grouped_ = false;             // slots are in order of the objects
  bool profiling_ = false;
  PhaseTicks ticks_{};
  SimState state_;
};

}  // namespace

std::unique_ptr<BatchSim> MakeLanesSim(const SimOptions& options, const HandModel& hand,
                                       std::vector<SimObject> objects, int num_envs,
                                       ThreadPool& pool) {
  return std::make_unique<LanesSim>(options, hand, objects, num_envs, pool);
}

std::vector<std::string> LaneInstructions() {
  std::vector<std::string> names;
  for (const LanesKernel& kernel : LanesKernels()) names.push_back(kernel.name);
  return names;
}

namespace {
LanesSim& AsLanes(const BatchSim& sim) {
  auto* lanes = dynamic_cast<const LanesSim*>(&sim);
  if (lanes == nullptr) Fail("profile: expected a simulator of the lanes engine");
  return const_cast<LanesSim&>(*lanes);
}
}  // namespace

LanesFootprint FootprintOf(const BatchSim& sim) { return AsLanes(sim).Footprint(); }
void StartProfile(BatchSim& sim) { AsLanes(sim).StartProfile(); }
LanesProfile StopProfile(BatchSim& sim) { return AsLanes(sim).StopProfile(); }

}  // namespace dexremoe
