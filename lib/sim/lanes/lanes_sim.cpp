#include "sim/lanes/lanes_sim.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <utility>

#include "base/bytes.h"
#include "base/check.h"
#include "base/error.h"
#include "sim/lanes/lane_store.h"
#include "sim/lanes/lanes_kernel.h"
#include "sim/lanes/object_field.h"
#include "sim/sim_shared.h"

namespace dexremoe {
namespace {

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
        store_(model_, num_envs),
        slot_(num_envs),
        env_of_slot_(num_envs),
        steps_(num_envs, 0),
        state_(SizedState(num_envs, hand)) {
    std::iota(slot_.begin(), slot_.end(), 0);
    std::iota(env_of_slot_.begin(), env_of_slot_.end(), 0);
    for (int env = 0; env < num_envs; ++env) Read(env);
  }

  int num_envs() const override { return num_envs_; }
  int num_joints() const override { return model_.layout.joints; }
  const SimState& state() const override { return state_; }

  void SetObject(int env, int object, const EnvPhysics& physics) override {
    CheckObject(env, object, model_.objects.size());
    grouped_ = grouped_ && store_.object(Slot(env)) == object;
    store_.PutObject(Slot(env), object, physics);
  }

  void SetState(int env, const EnvState& state) override {
    CheckStateToSet(env, state, num_joints());
    store_.PutState(Slot(env), state);
    steps_[env] = 0;
    Read(env);
  }

  std::vector<std::uint8_t> Save(int env) const override {
    ByteWriter out;
    out.Put(steps_[env]);
    out.Put(static_cast<std::int64_t>(store_.object(Slot(env))));
    out.PutVector(store_.Numbers(Slot(env)));
    return out.Take();
  }

  void Restore(int env, std::span<const std::uint8_t> bytes) override {
    ByteReader in(bytes);
    const auto steps = in.Get<std::int64_t>();
    const auto object = static_cast<int>(in.Get<std::int64_t>());
    const std::vector<float> numbers = in.GetVector<float>();
    in.Finish();
    CheckObject(env, object, model_.objects.size());
    grouped_ = grouped_ && store_.object(Slot(env)) == object;
    store_.PutNumbers(Slot(env), object, numbers);
    steps_[env] = steps;
    Read(env);
  }

  void SetHeld(int env, bool held) override { store_.PutHeld(Slot(env), held); }
  void PushObject(int env, const Vector3d& force) override { store_.PutPush(Slot(env), force); }

  void Step(std::span<const double> targets, std::span<const std::uint8_t> active) override {
    CheckTargets(targets, active, *this, steps_);
    if (!grouped_) Group();
    std::vector<KernelCounts> counts(profiling_ ? pool_.workers() : 0);
    pool_.ParallelFor(store_.blocks(), [&](int block, int worker) {
      StepOne(block, targets, active, profiling_ ? &counts[worker] : nullptr);
    });
    for (const KernelCounts& worker : counts) counts_.Add(worker);
  }

  LanesFootprint Footprint() const {
    return {model_.layout.rows * sizeof(float), kFieldSize * sizeof(std::int16_t), kBlockLanes,
            kernel_.name};
  }
  void StartProfile() {
    profiling_ = true;
    counts_ = {};
  }
  LanesProfile StopProfile() {
    profiling_ = false;
    LanesProfile profile;
    profile.phases = {"kinematics and dynamics", "distance field", "contact set-up", "solver",
                      "finish"};
    const double sum = std::accumulate(counts_.ticks.begin(), counts_.ticks.end(), 0.0);
    for (const std::uint64_t ticks : counts_.ticks)
      profile.shares.push_back(ticks / std::max(sum, 1.0));
    profile.slots = counts_.slots / std::max(1.0, static_cast<double>(counts_.substeps));
    profile.occupancy = counts_.points / std::max(1.0, static_cast<double>(counts_.lanes));
    return profile;
  }

 private:
  int Slot(int env) const {
    DEX_CHECK_GE(env, 0);
    DEX_CHECK_LT(env, num_envs_);
    return slot_[env];
  }

  // Sorts environments by object, so that the fields a worker reads stay in its cache.
  void Group() {
    std::vector<int> order(num_envs_);  // slots
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return store_.object(a) < store_.object(b); });
    store_.Reorder(order);
    const std::vector<int> env_of = env_of_slot_;
    for (int slot = 0; slot < num_envs_; ++slot) {
      env_of_slot_[slot] = env_of[order[slot]];
      slot_[env_of_slot_[slot]] = slot;
    }
    grouped_ = true;
  }

  // Steps the active environments of a block. The kernel moves all lanes; the others are put back.
  void StepOne(int block, std::span<const double> targets, std::span<const std::uint8_t> active,
               KernelCounts* counts) {
    const int first = block * kBlockLanes, last = std::min(first + kBlockLanes, num_envs_);
    std::vector<std::pair<int, std::vector<float>>> resting;  // slots and their numbers
    for (int slot = first; slot < last; ++slot) {
      const std::size_t env = env_of_slot_[slot];
      if (!active.empty() && !active[env]) resting.emplace_back(slot, store_.Numbers(slot));
    }
    if (static_cast<int>(resting.size()) == last - first) return;
    for (int slot = first; slot < last; ++slot)
      store_.PutTargets(slot,
                        &targets[static_cast<std::size_t>(env_of_slot_[slot]) * num_joints()]);
    PrefetchNext(block, targets);
    kernel_.step(model_, store_.Block(block), counts);
    for (const auto& [slot, numbers] : resting)
      store_.PutNumbers(slot, store_.object(slot), numbers);
    const bool finite = store_.AllFinite(block);
    for (int slot = first; slot < last; ++slot) {
      const int env = env_of_slot_[slot];
      if (!active.empty() && !active[env]) continue;
      Read(env);
      if (!finite) CheckRow(state_, env, steps_[env]);
      ++steps_[env];
    }
  }

  // The block that a worker takes up after this one: its numbers, and the rows of state and targets
  // of its environments, which lie apart when objects alternate.
  void PrefetchNext(int block, std::span<const double> targets) const {
    const int next = block + pool_.workers();
    if (next >= store_.blocks()) return;
    store_.Prefetch(next);
    const std::size_t joints = num_joints();
    const int last = std::min((next + 1) * kBlockLanes, num_envs_);
    for (int slot = next * kBlockLanes; slot < last; ++slot) {
      const std::size_t env = env_of_slot_[slot];
      for (std::size_t j = 0; j < joints; j += 8) {  // lines of 8 numbers
        __builtin_prefetch(&targets[env * joints + j], 0, 2);
        __builtin_prefetch(&state_.joint_position[env * joints + j], 1, 2);
        __builtin_prefetch(&state_.joint_velocity[env * joints + j], 1, 2);
      }
      __builtin_prefetch(&state_.object_position[3 * env], 1, 2);
      __builtin_prefetch(&state_.object_rotation[4 * env], 1, 2);
      __builtin_prefetch(&state_.object_velocity[3 * env], 1, 2);
      __builtin_prefetch(&state_.object_spin[3 * env], 1, 2);
    }
  }

  void Read(int env) { store_.Read(slot_[env], env, state_); }

  LanesModel model_;
  LanesKernel kernel_;
  ThreadPool& pool_;
  int num_envs_;
  LaneStore store_;
  std::vector<int> slot_;            // [N] where each environment is
  std::vector<int> env_of_slot_;     // [N] and back
  std::vector<std::int64_t> steps_;  // [N] control steps since SetState
  bool grouped_ = false;             // slots are in order of the objects
  bool profiling_ = false;
  KernelCounts counts_;
  SimState state_;
};

LanesSim& AsLanes(const BatchSim& sim) {
  auto* lanes = dynamic_cast<const LanesSim*>(&sim);
  if (lanes == nullptr) Fail("profile: expected a simulator of the lanes engine");
  return const_cast<LanesSim&>(*lanes);
}

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

LanesFootprint FootprintOf(const BatchSim& sim) { return AsLanes(sim).Footprint(); }
void StartProfile(BatchSim& sim) { AsLanes(sim).StartProfile(); }
LanesProfile StopProfile(BatchSim& sim) { return AsLanes(sim).StopProfile(); }

}  // namespace dexremoe
