#include "sim/mujoco/mujoco_sim.h"

#include "base/error.h"

#if __has_include(<mujoco/mujoco.h>)

#include <algorithm>
#include <string>
#include <utility>

#include "base/check.h"
#include "sim/mujoco/mujoco_env.h"
#include "sim/sim_shared.h"

namespace dexremoe {
namespace {

// Environments are dealt out in this many chunks at most, whatever the number of workers.
constexpr int kMaxChunks = 64;

class MujocoSim : public BatchSim {
 public:
  MujocoSim(const SimOptions& options, const HandModel& hand, std::vector<SimObject> objects,
            int num_envs, ThreadPool& pool)
      : scene_(options, hand, std::move(objects)), pool_(pool), steps_(num_envs) {
    for (int env = 0; env < num_envs; ++env) envs_.push_back(std::make_unique<MujocoEnv>(scene_));
    for (int w = 0; w < pool.workers(); ++w) scratch_.emplace_back(scene_.objects().size());
    state_ = SizedState(num_envs, scene_.hand());
    for (int env = 0; env < num_envs; ++env) envs_[env]->Read(state_, env);
  }

  int num_envs() const override { return static_cast<int>(envs_.size()); }
  int num_joints() const override { return scene_.hand().num_joints(); }
  const SimState& state() const override { return state_; }

  void SetObject(int env, int object, const EnvPhysics& physics) override {
    CheckObject(env, object, scene_.objects().size());
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
    for (int env = 0; env < num_envs(); ++env) steps_[env] = envs_[env]->steps();
    CheckTargets(targets, active, *this, steps_);
    const std::int64_t n = num_envs(), chunks = std::min<std::int64_t>(n, kMaxChunks);
    pool_.ParallelFor(static_cast<int>(chunks), [&](int c, int worker) {
      for (std::int64_t env = n * c / chunks; env < n * (c + 1) / chunks; ++env)
        if (active.empty() || active[env])
          StepOne(static_cast<int>(env), targets.data() + env * num_joints(), scratch_[worker]);
    });
  }

 private:
  void StepOne(int env, const double* targets, MujocoScratch& scratch) {
    std::string failure;
    try {
      envs_[env]->Step(targets, scratch);
    } catch (const Error& error) {
      failure = error.what();
      scratch.Discard(envs_[env]->object());
    }
    envs_[env]->Read(state_, env);
    CheckRow(state_, env, steps_[env]);
    if (!failure.empty()) Fail("environment {}: step {}: {}", env, steps_[env], failure);
  }

  MujocoEnv& At(int env) {
    DEX_CHECK_GE(env, 0);
    DEX_CHECK_LT(env, num_envs());
    return *envs_[env];
  }

  MujocoScene scene_;
  ThreadPool& pool_;
  std::vector<std::unique_ptr<MujocoEnv>> envs_;
  std::vector<MujocoScratch> scratch_;  // per worker
  SimState state_;
  std::vector<std::int64_t> steps_;  // [N] control steps since SetState, before a Step
};

}  // namespace

bool MujocoAvailable() { return true; }

std::unique_ptr<BatchSim> MakeMujocoSim(const SimOptions& options, const HandModel& hand,
                                        std::vector<SimObject> objects, int num_envs,
                                        ThreadPool& pool) {
  return std::make_unique<MujocoSim>(options, hand, std::move(objects), num_envs, pool);
}

}  // namespace dexremoe

#else

namespace dexremoe {

bool MujocoAvailable() { return false; }

std::unique_ptr<BatchSim> MakeMujocoSim(const SimOptions&, const HandModel&, std::vector<SimObject>,
                                        int, ThreadPool&) {
  Fail("sim.engine: this build has no MuJoCo; install libmujoco-dev and run make again");
}

}  // namespace dexremoe

#endif
