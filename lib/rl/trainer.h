// The training loop: rollout, update, curriculum, figures.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/thread_pool.h"
#include "policy/policy.h"
#include "rl/communicator.h"
#include "rl/env.h"
#include "rl/ppo.h"
#include "rl/ppo_options.h"
#include "rl/rollout.h"
#include "rl/train_state.h"

namespace dexremoe {

// Wall-clock of one iteration; kept apart from the state, which must not depend on it.
struct IterationTime {
  double rollout = 0, update = 0;  // s
};

class Trainer {
 public:
  // Continues from `state`: restores the environments when state.environment is filled, by as many
  // ranks as there are, else starts new episodes. `env` is this rank's share of the environments;
  // all else, `state` too, is and stays equal on every rank. All references must outlive this.
  Trainer(const PpoOptions& options, const TaskDifficulty& task, TrainState state, VecEnv& env,
          ThreadPool& pool, Communicator& communicator = Alone(), const AdrOptions& adr = {});
  ~Trainer();

  // One rollout and update; appends to state().curve.
  const CurveRow& Iterate();
  // Whether the last Iterate raised state().best. A score counts once the window is full of
  // episodes that began at the present difficulty: what came before says nothing about it.
  bool improved() const { return improved_; }
  const IterationTime& time() const { return time_; }

  const TrainState& state() const { return state_; }
  const Policy<float>& policy() const { return *policy_; }
  // The state with the environments' bytes, ready for WriteCheckpoint; valid until Iterate. All
  // ranks must call it; only rank 0 has the bytes.
  const TrainState& Snapshot();

 private:
  std::vector<EpisodeRecord> RecordsOfAllRanks(std::vector<EpisodeRecord> records);
  void AddRecords(const std::vector<EpisodeRecord>& records);
  void SetDifficulty();
  void Judge();
  CurveRow MakeRow(const UpdateStats& stats, double learning_rate) const;

  PpoOptions options_;
  AdrOptions adr_;
  TrainState state_;
  VecEnv& env_;
  Communicator& communicator_;
  std::unique_ptr<Policy<float>> policy_;
  Curriculum curriculum_;
  std::unique_ptr<ShapeRows> shapes_;
  std::unique_ptr<Rollout> rollout_;
  std::unique_ptr<PpoLearner> learner_;
  IterationTime time_;
  bool improved_ = false;
};

}  // namespace dexremoe
