#include "sim/ode/ode_sim.h"

#include <algorithm>
#include <string>
#include <utility>

#include "base/check.h"
#include "base/error.h"
#include "sim/ode/ode_env.h"
#include "sim/sim_shared.h"

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
    state_ = SizedState(num_envs, model_.hand);
    steps_.resize(num_envs);
    for (int env = 0; env < num_envs; ++env) envs_[env]->Read(state_, env);
  }

  int num_envs() const override { return num_envs_; }
  int num_joints() const override { return model_.hand.num_joints(); }
  const SimState& state() const override { return state_; }

  void SetObject(int env, int object, const EnvPhysics& physics) override {
    CheckObject(env, object, model_.objects.size());
    At(env).SetObject(object, physics);
  }

  void SetState(int env, const EnvState& state) override {
    CheckStateToSet(env, state, num_joints());
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
    for (int env = 0; env < num_envs_; ++env) steps_[env] = envs_[env]->steps();
    CheckTargets(targets, active, *this, steps_);
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
    const std::int64_t step = steps_[env];
    std::string failure;
    try {
      envs_[env]->Step(targets, chunk.finder);
    } catch (const Error& error) {
      failure = error.what();
      chunk.arena.Recover();
    }
    envs_[env]->Read(state_, env);
    CheckRow(state_, env, step);
    if (!failure.empty()) Fail("environment {}: step {}: {}", env, step, failure);
  }

  OdeEnv& At(int env) {
    DEX_CHECK_GE(env, 0);
    DEX_CHECK_LT(env, num_envs_);
    return *envs_[env];
  }

  OdeModel model_;
  int num_envs_;
  ThreadPool& pool_;
  std::vector<std::unique_ptr<Chunk>> chunks_;
  std::vector<OdeEnv*> envs_;
  SimState state_;
  std::vector<std::int64_t> steps_;  // [N] control steps since SetState, before a Step
};

}  // namespace

std::unique_ptr<BatchSim> MakeOdeSim(const SimOptions& options, const HandModel& hand,
                                     std::vector<SimObject> objects, int num_envs,
                                     ThreadPool& pool) {
  return std::make_unique<OdeSim>(options, hand, std::move(objects), num_envs, pool);
}

}  // namespace dexremoe
