// Proximal policy optimisation (Schulman et al. 2017): the update of one iteration.
#pragma once

#include <memory>
#include <vector>

#include "base/thread_pool.h"
#include "policy/policy_net.h"
#include "rl/communicator.h"
#include "rl/ppo_loss.h"
#include "rl/ppo_options.h"
#include "rl/rollout.h"
#include "rl/train_state.h"
#include "rl/trainable.h"

namespace dexremoe {

// Means over the rows of all mini-epochs.
struct UpdateStats {
  double policy_loss = 0, value_loss = 0, kl = 0, clip_fraction = 0, gradient_norm = 0;
  double explained_variance = 0;  // of the targets, by the values of the rollout
  // Of a policy that routes rows to experts; else 0.
  double routing_entropy = 0;            // nats
  double least_load = 0, most_load = 0;  // shares of the idlest and the busiest expert
  double auxiliary_loss = 0;             // its own losses, weighted
};

// The adaptive rule, applied once per mini-epoch: down by rate_factor above twice the threshold, up
// below half of it, within [rate_min, rate_max].
double AdaptRate(const PpoOptions& options, double threshold, double kl, double rate);

// Each minibatch is cut into blocks of rows; a block's gradient is one unit of work, and gradients
// are summed in block order. So the result does not depend on the number of threads.
class PpoLearner {
 public:
  // All must outlive this. Every rank brings as many rows; options.minibatch counts those of all.
  PpoLearner(const PpoOptions& options, const Policy<float>& policy, ThreadPool& pool,
             Communicator& communicator = Alone());

  // Changes params, adam, learning_rate and normalizers.value of `state`. Throws Error naming
  // iteration and block when a gradient or a parameter is not finite.
  UpdateStats Update(const RolloutBatch& batch, const ShapeInputs<float>& shapes,
                     TrainState& state);

 private:
  // What a block of rows adds up.
  struct BlockSums {
    double policy_loss = 0, value_loss = 0, kl = 0, clipped = 0;
    std::vector<double> dlog_std;  // [A]
    RoutingSums routing;
  };
  // Rows of a block gathered from the batch, and what the policy makes of them. Per worker.
  struct Scratch {
    std::vector<float> obs, phys, frozen, noise, mean, value, dmean, dvalue;
    std::vector<int> object;
  };
  void Prepare(const RolloutBatch& batch, TrainState& state);
  void Minibatch(const RolloutBatch& batch, const ShapeInputs<float>& shapes, const int* rows,
                 int count, TrainState& state, BlockSums& total);
  void Block(int worker, const RolloutBatch& batch, const ShapeInputs<float>& shapes,
             const int* rows, int count, double row_weight, float* grads, BlockSums& sums);
  void SumOverRanks(BlockSums& total);
  void AddRoutingStats(const RoutingSums& total, double share, UpdateStats& stats) const;
  PolicyRows<float> Gather(const RolloutBatch& batch, const int* rows, int count,
                           Scratch& scratch) const;
  void RowLoss(const RolloutBatch& batch, int row, float row_weight, const float* mean, float value,
               float* dmean, float* dvalue, BlockSums& sums);
  // Makes the spread at hand the last of spreads_.
  void AddSpread(const TrainState& state);
  void ReduceGradients(int blocks, const std::vector<BlockSums>& sums);
  void CheckFinite(const std::vector<float>& values, const char* what, const TrainState& state);

  PpoOptions options_;
  const Policy<float>& policy_;
  ThreadPool& pool_;
  Communicator& communicator_;
  std::unique_ptr<PolicyNet> net_;
  TrainableSet trainable_;
  bool follow_previous_;  // kl_reference
  // Of the batch at hand.
  std::vector<float> advantage_, target_, old_value_;  // [R]; the last two normalised
  std::vector<int> order_;                             // [R]
  // For the KL divergence: the spreads of the rollout and of each optimiser step since, their part
  // of the divergence of the last one from them, and each row's reference.
  std::vector<ActionSpread<float>> spreads_;
  std::vector<float> spread_kl_;
  std::vector<float> reference_mean_;  // [R, A]
  std::vector<int> reference_spread_;  // [R], into spreads_
  // Work.
  std::vector<std::unique_ptr<float[]>> block_grads_;
  std::vector<Scratch> scratch_;
  std::vector<float> grads_, values_;  // of the trainable set
};

}  // namespace dexremoe
