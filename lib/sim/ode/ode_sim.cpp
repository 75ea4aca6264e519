#include "sim/ode/ode_sim.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/check.h"
#include "base/error.h"
#include "sim/ode/ode_env.h"

namespace dexremoe {
namespace {

// Environments are dealt out in this many chunks at most, whatever the number of workers.
constexpr int kMaxChunks = 64;

struct Chunk {
  explicit Chunk(const ContactModel& contacts) : finder(contacts) {}
  OdeArena arena;
  ContactFinder finder;
  int first = 0, last = 0;  // environments [first, last)
  std::vector<std::unique_ptr<OdeEnv>> envs;
};

bool AllFinite(const double* values, int count) {
  return std::all_of(values, values + count, [](double v) { return std::isfinite(v); });
}

class OdeSim : public BatchSim {
 public:
  OdeSim(const SimOptions& options, const HandModel& hand, std::vector<SimObject> objects,
         int num_envs, ThreadPool& pool)
      : model_{options, hand, std::move(objects), ContactModelOf(hand)},
        num_envs_(num_envs),
        pool_(pool) {
    for (const SimObject& object : model_.objects)
      model_.contacts.objects.push_back(ShapeOfObject(object.parts, object.name));
    const int chunks = std::min(num_envs, kMaxChunks);
    for (int c = 0; c < chunks; ++c) {
      auto chunk = std::make_unique<Chunk>(model_.contacts);
      chunk->first = static_cast<int>(static_cast<std::int64_t>(num_envs) * c / chunks);
      chunk->last = static_cast<int>(static_cast<std::int64_t>(num_envs) * (c + 1) / chunks);
      for (int env = chunk->first; env < chunk->last; ++env) {
        chunk->envs.push_back(std::make_unique<OdeEnv>(model_, chunk->arena));
        envs_.push_back(chunk->envs.back().get());
      }
      chunks_.push_back(std::move(chunk));
    }
    SizeState();
    for (int env = 0; env < num_envs; ++env) envs_[env]->Read(state_, env);
  }

  int num_envs() const override { return num_envs_; }
  int num_joints() const override { return model_.hand.num_joints(); }
  const SimState& state() const override { return state_; }

  void SetObject(int env, int object, const EnvPhysics& physics) override {
    if (object < 0 || object >= static_cast<int>(model_.objects.size()))
      Fail("environment {}: object: expected 0..{}, found {}", env, model_.objects.size() - 1,
           object);
    At(env).SetObject(object, physics);
  }

  void SetState(int env, const EnvState& state) override {
    if (!AllFinite(state.q.data(), num_joints()) || !AllFinite(state.qd.data(), num_joints()) ||
        !state.X_WO.p.allFinite() || !state.X_WO.q.coeffs().allFinite() || !state.v.allFinite() ||
        !state.w.allFinite())
      Fail("environment {}: state to set: expected finite numbers", env);
    At(env).SetState(state);
    envs_[env]->Read(state_, env);
  }

  std::vector<std::uint8_t> Save(int env) const override {
    ByteWriter out;
    envs_.at(env)->Save(out);
    return out.Take();
  }

  void Restore(int env, std::span<const std::uint8_t> bytes) override {
    ByteReader in(bytes);
    At(env).Restore(in);
    in.Finish();
    envs_[env]->Read(state_, env);
  }

  void SetHeld(int env, bool held) override { At(env).SetHeld(held); }
  void PushObject(int env, const Eigen::Vector3d& force) override { At(env).Push(force); }

  void Step(std::span<const double> targets, std::span<const std::uint8_t> active) override {
    DEX_CHECK_EQ(targets.size(), static_cast<std::size_t>(num_envs_) * num_joints());
    if (!active.empty()) DEX_CHECK_EQ(active.size(), static_cast<std::size_t>(num_envs_));
    for (int env = 0; env < num_envs_; ++env)
      if ((active.empty() || active[env]) && !AllFinite(&targets[env * num_joints()], num_joints()))
        Fail("environment {}: step {}: target: expected finite angles", env, envs_[env]->steps());
    pool_.ParallelFor(static_cast<int>(chunks_.size()), [&](int c, int) {
      PrepareOdeThread();
      Chunk& chunk = *chunks_[c];
      for (int env = chunk.first; env < chunk.last; ++env) {
        if (!active.empty() && !active[env]) continue;
        StepOne(env, &targets[env * num_joints()], chunk);
      }
    });
  }

 private:
  void StepOne(int env, const double* targets, Chunk& chunk) {
    const std::int64_t step = envs_[env]->steps();
    std::string failure;
    try {
      envs_[env]->Step(targets, chunk.finder);
    } catch (const Error& error) {
      failure = error.what();
      chunk.arena.Recover();
    }
    envs_[env]->Read(state_, env);
    CheckFinite(env, step);
    if (!failure.empty()) Fail("environment {}: step {}: {}", env, step, failure);
  }

  OdeEnv& At(int env) {
    DEX_CHECK_GE(env, 0);
    DEX_CHECK_LT(env, num_envs_);
    return *envs_[env];
  }

  void SizeState() {
    const std::size_t n = num_envs_, joints = num_joints();
    state_.joint_position.resize(n * joints);
    state_.joint_velocity.resize(n * joints);
    state_.object_position.resize(n * 3);
    state_.object_rotation.resize(n * 4);
    state_.object_velocity.resize(n * 3);
    state_.object_spin.resize(n * 3);
    state_.tip_contact.resize(n * model_.hand.chains.size());
    state_.contact_count.resize(n);
    state_.max_penetration.resize(n);
  }

  void CheckFinite(int env, std::int64_t step) const {
    const auto check = [&](const std::vector<double>& values, int width, const char* field) {
      if (!AllFinite(&values[static_cast<std::size_t>(env) * width], width))
        Fail("environment {}: step {}: {}: expected finite numbers (unstable simulation?)", env,
             step, field);
    };
    check(state_.joint_position, num_joints(), "joint_position");
    check(state_.joint_velocity, num_joints(), "joint_velocity");
    check(state_.object_position, 3, "object_position");
    check(state_.object_rotation, 4, "object_rotation");
    check(state_.object_velocity, 3, "object_velocity");
    check(state_.object_spin, 3, "object_spin");
  }

  OdeModel model_;
  int num_envs_;
  ThreadPool& pool_;
  std::vector<std::unique_ptr<Chunk>> chunks_;
  std::vector<OdeEnv*> envs_;
  SimState state_;
};

}  // namespace

std::unique_ptr<BatchSim> MakeOdeSim(const SimOptions& options, const HandModel& hand,
                                     std::vector<SimObject> objects, int num_envs,
                                     ThreadPool& pool) {
  if (objects.empty()) Fail("simulator: expected at least one object");
  if (num_envs < 1) Fail("simulator: expected at least one environment, found {}", num_envs);
  return std::make_unique<OdeSim>(options, hand, std::move(objects), num_envs, pool);
}

}  // namespace dexremoe
