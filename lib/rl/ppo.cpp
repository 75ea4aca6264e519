#include "rl/ppo.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/error.h"
#include "base/random.h"
#include "nn/kernels.h"
#include "rl/gae.h"
#include "rl/rank_statistics.h"

namespace dexremoe {
namespace {

// Fisher-Yates, from (seed, kShuffle, iteration, epoch) and, where there are others, the rank.
void Shuffle(std::uint64_t seed, std::int64_t iteration, int epoch, const Communicator& ranks,
             std::vector<int>& order) {
  const auto i = static_cast<std::uint64_t>(iteration), e = static_cast<std::uint64_t>(epoch),
             rank = static_cast<std::uint64_t>(ranks.rank());
  Rng rng(ranks.size() == 1 ? SeedOf(seed, Stream::kShuffle, {i, e})
                            : SeedOf(seed, Stream::kShuffle, {i, e, rank}));
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<int>(k);
  for (std::size_t k = order.size(); k > 1; --k) std::swap(order[k - 1], order[rng.Index(k)]);
}

// Copies the rows of a [R, width] matrix.
template <typename T>
void GatherRows(const std::vector<T>& from, int width, const int* rows, int count,
                std::vector<T>& to) {
  to.resize(static_cast<std::size_t>(count) * width);
  for (int i = 0; i < count; ++i)
    std::copy_n(from.begin() + static_cast<std::size_t>(rows[i]) * width, width,
                to.begin() + static_cast<std::size_t>(i) * width);
}

}  // namespace

double AdaptRate(const PpoOptions& options, double threshold, double kl, double rate) {
  if (kl > 2 * threshold) return std::max(rate / options.rate_factor, options.rate_min);
  if (kl < 0.5 * threshold) return std::min(rate * options.rate_factor, options.rate_max);
  return rate;
}

PpoLearner::PpoLearner(const PpoOptions& options, const Policy<float>& policy, ThreadPool& pool,
                       Communicator& communicator)
    : options_(options),
      policy_(policy),
      pool_(pool),
      communicator_(communicator),
      net_(MakePolicyNet(policy.structure(), pool.workers())),
      trainable_(policy.layout(), policy.trainable()),
      follow_previous_(options.kl_reference == "previous"),
      scratch_(pool.workers()) {}

UpdateStats PpoLearner::Update(const RolloutBatch& batch, const ShapeInputs<float>& shapes,
                               TrainState& state) {
  UpdateStats stats;
  ComputeGae(batch.steps, batch.envs, options_.gamma, options_.lambda, batch.reward, batch.done,
             batch.value, batch.last_value, advantage_, target_);
  stats.explained_variance = ExplainedVariance(communicator_, batch.value, target_);
  Prepare(batch, state);
  const int rows = static_cast<int>(order_.size());
  const std::int64_t all_rows = static_cast<std::int64_t>(rows) * communicator_.size();
  const int minibatches = static_cast<int>(
      std::max<std::int64_t>(1, (all_rows + options_.minibatch / 2) / options_.minibatch));
  for (int epoch = 0; epoch < options_.mini_epochs; ++epoch) {
    Shuffle(state.seed, state.iteration, epoch, communicator_, order_);
    BlockSums total;
    double norm = 0;
    for (int m = 0; m < minibatches; ++m) {
      const int begin = static_cast<int>(static_cast<std::int64_t>(rows) * m / minibatches);
      const int end = static_cast<int>(static_cast<std::int64_t>(rows) * (m + 1) / minibatches);
      Minibatch(batch, shapes, order_.data() + begin, end - begin, state, total);
      norm += ClipGradient(options_.max_grad_norm, grads_);
      CheckFinite(grads_, "gradient", state);
      AdamStep({}, state.learning_rate, grads_, state.adam, values_);
      trainable_.Scatter(values_, state.params);
    }
    SumOverRanks(total);
    const double share = 1.0 / (static_cast<double>(all_rows) * options_.mini_epochs);
    stats.policy_loss += total.policy_loss * share;
    stats.value_loss += total.value_loss * share;
    stats.kl += total.kl * share;
    stats.clip_fraction += total.clipped * share;
    AddRoutingStats(total.routing, share, stats);
    stats.gradient_norm += norm / minibatches / options_.mini_epochs;
    if (options_.adaptive)
      state.learning_rate =
          AdaptRate(options_, options_.KlThreshold(state.samples),
                    total.kl / static_cast<double>(all_rows), state.learning_rate);
  }
  CheckFinite(values_, "value", state);
  return stats;
}

// Normalises advantages over the batch, and values and targets with the moments that include
// these targets (rl_games).
void PpoLearner::Prepare(const RolloutBatch& batch, TrainState& state) {
  const std::int64_t rows = static_cast<std::int64_t>(target_.size());
  const int actions = policy_.structure().num_actions;
  RunningMoments& moments = state.normalizers.value;
  RunningMoments fresh = EmptyMoments(1);
  UpdateMoments(rows, target_.data(), fresh);
  MergeMoments(communicator_, fresh, moments);
  old_value_ = batch.value;
  NormalizeValues(moments, old_value_.data(), rows);
  NormalizeValues(moments, target_.data(), rows);
  NormalizeAdvantages(communicator_, advantage_);
  reference_mean_ = batch.mean;
  reference_spread_.assign(rows, 0);
  spreads_.assign(1, ActionSpread<float>(actions, batch.log_std.data()));
  order_.resize(rows);
  trainable_.Gather(state.params, values_);
}

void PpoLearner::AddSpread(const TrainState& state) {
  const ParamBlock& block = policy_.layout().block(policy_.log_std_block());
  spreads_.emplace_back(policy_.structure().num_actions, state.params.data() + block.offset);
  spread_kl_.clear();
  for (const ActionSpread<float>& before : spreads_)
    spread_kl_.push_back(KlOfSpreads(spreads_.back(), before));
}

void PpoLearner::Minibatch(const RolloutBatch& batch, const ShapeInputs<float>& shapes,
                           const int* rows, int count, TrainState& state, BlockSums& total) {
  const int blocks = (count + options_.block_rows - 1) / options_.block_rows;
  // Not initialised: frozen ranges are never touched and so take no memory.
  while (static_cast<int>(block_grads_.size()) < blocks)
    block_grads_.push_back(std::make_unique_for_overwrite<float[]>(policy_.layout().size()));
  AddSpread(state);
  net_->Load(state.params);
  std::vector<BlockSums> sums(blocks);
  const double row_weight = 1.0 / (static_cast<double>(count) * communicator_.size());
  pool_.ParallelFor(blocks, [&](int block, int worker) {
    const int begin = block * options_.block_rows;
    const int size = std::min(options_.block_rows, count - begin);
    Block(worker, batch, shapes, rows + begin, size, row_weight, block_grads_[block].get(),
          sums[block]);
  });
  ReduceGradients(blocks, sums);
  communicator_.Sum(grads_);
  for (const BlockSums& s : sums) {
    total.policy_loss += s.policy_loss;
    total.value_loss += s.value_loss;
    total.kl += s.kl;
    total.clipped += s.clipped;
    total.routing.Add(s.routing);
  }
}

void PpoLearner::SumOverRanks(BlockSums& total) {
  std::vector<double> sums = {total.policy_loss, total.value_loss,   total.kl,
                              total.clipped,     total.routing.loss, total.routing.entropy};
  sums.insert(sums.end(), total.routing.load.begin(), total.routing.load.end());
  communicator_.Sum(sums);
  total.policy_loss = sums[0];
  total.value_loss = sums[1];
  total.kl = sums[2];
  total.clipped = sums[3];
  total.routing = {sums[4], sums[5], {sums.begin() + 6, sums.end()}};
}

void PpoLearner::AddRoutingStats(const RoutingSums& total, double share, UpdateStats& stats) const {
  if (total.load.empty()) return;
  const auto [least, most] = std::minmax_element(total.load.begin(), total.load.end());
  stats.routing_entropy += total.entropy * share;
  stats.least_load += *least * share;
  stats.most_load += *most * share;
  stats.auxiliary_loss += total.loss * share;
}

PolicyRows<float> PpoLearner::Gather(const RolloutBatch& batch, const int* rows, int count,
                                     Scratch& scratch) const {
  const PolicyStructure& s = policy_.structure();
  GatherRows(batch.obs, s.obs_size, rows, count, scratch.obs);
  GatherRows(batch.phys, s.phys_size, rows, count, scratch.phys);
  GatherRows(batch.object, 1, rows, count, scratch.object);
  GatherRows(batch.frozen, policy_.frozen_size(), rows, count, scratch.frozen);
  GatherRows(batch.noise, policy_.noise_size(), rows, count, scratch.noise);
  return {count,
          scratch.obs.data(),
          scratch.phys.data(),
          scratch.object.data(),
          policy_.frozen_size() > 0 ? scratch.frozen.data() : nullptr,
          policy_.noise_size() > 0 ? scratch.noise.data() : nullptr};
}

void PpoLearner::Block(int worker, const RolloutBatch& batch, const ShapeInputs<float>& shapes,
                       const int* rows, int count, double row_weight, float* grads,
                       BlockSums& sums) {
  Scratch& scratch = scratch_[worker];
  const int actions = policy_.structure().num_actions;
  for (const TrainableSet::Range& range : trainable_.ranges())
    std::fill_n(grads + range.offset, range.size, 0.0f);
  const PolicyRows<float> in = Gather(batch, rows, count, scratch);
  scratch.mean.resize(static_cast<std::size_t>(count) * actions);
  scratch.value.resize(count);
  net_->Forward(worker, shapes, in, scratch.mean.data(), scratch.value.data());
  scratch.dmean.assign(scratch.mean.size(), 0.0f);
  scratch.dvalue.assign(count, 0.0f);
  sums.dlog_std.assign(actions, 0.0);
  for (int i = 0; i < count; ++i)
    RowLoss(batch, rows[i], static_cast<float>(row_weight), scratch.mean.data() + i * actions,
            scratch.value[i], scratch.dmean.data() + i * actions, &scratch.dvalue[i], sums);
  for (double& d : sums.dlog_std) d -= count * row_weight * options_.entropy_coef;
  // Balance is judged over the block, as a group of rows.
  if (policy_.routes())
    net_->Balance(worker, shapes, in, static_cast<float>(count * row_weight), sums.routing);
  net_->Backward(worker, shapes, in, scratch.dmean.data(), scratch.dvalue.data(), grads);
}

// loss = surrogate + 0.5 critic_coef value + bounds_coef bounds - entropy_coef entropy, mean over
// the minibatch (rl_games).
void PpoLearner::RowLoss(const RolloutBatch& batch, int row, float row_weight, const float* mean,
                         float value, float* dmean, float* dvalue, BlockSums& sums) {
  const int actions = policy_.structure().num_actions;
  const ActionSpread<float>& spread = spreads_.back();
  const float* action = batch.action.data() + static_cast<std::size_t>(row) * actions;
  const auto surrogate = Surrogate(LogProbability(spread, action, mean), batch.log_prob[row],
                                   advantage_[row], static_cast<float>(options_.clip));
  AddLogProbabilityGradient(spread, action, mean, row_weight * surrogate.dloss_dlogp, dmean,
                            sums.dlog_std.data());
  const auto fit = SquaredValueLoss(value, old_value_[row], target_[row],
                                    static_cast<float>(options_.clip), options_.clip_value);
  *dvalue = row_weight * static_cast<float>(0.5 * options_.critic_coef) * fit.dloss_dvalue;
  BoundsLoss(actions, mean, static_cast<float>(options_.bounds),
             row_weight * static_cast<float>(options_.bounds_coef), dmean);
  sums.policy_loss += surrogate.loss;
  sums.value_loss += fit.loss;
  sums.clipped += surrogate.clipped;

  float* reference_mean = reference_mean_.data() + static_cast<std::size_t>(row) * actions;
  int& reference = reference_spread_[row];
  sums.kl += spread_kl_[reference] + KlOfMeans(mean, reference_mean, spreads_[reference]);
  if (!follow_previous_) return;
  std::copy_n(mean, actions, reference_mean);
  reference = static_cast<int>(spreads_.size()) - 1;
}

void PpoLearner::ReduceGradients(int blocks, const std::vector<BlockSums>& sums) {
  constexpr std::int64_t kSlice = 16384;  // elements per unit of work
  grads_.resize(trainable_.size());
  for (const TrainableSet::Range& range : trainable_.ranges()) {
    const int slices = static_cast<int>((range.size + kSlice - 1) / kSlice);
    pool_.ParallelFor(slices, [&](int slice, int) {
      const std::int64_t begin = slice * kSlice, end = std::min(range.size, begin + kSlice);
      float* to = grads_.data() + range.dense;
      std::fill(to + begin, to + end, 0.0f);
      for (int block = 0; block < blocks; ++block) {
        const float* from = block_grads_[block].get() + range.offset;
        AddTo(end - begin, from + begin, to + begin);
      }
    });
  }
  const std::int64_t spread = trainable_.DenseOffset(policy_.log_std_block());
  if (spread < 0) return;
  for (int a = 0; a < policy_.structure().num_actions; ++a) {
    double sum = 0;
    for (const BlockSums& s : sums) sum += s.dlog_std[a];
    grads_[spread + a] = static_cast<float>(sum);
  }
}

void PpoLearner::CheckFinite(const std::vector<float>& values, const char* what,
                             const TrainState& state) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]))
      Fail("ppo: iteration {}: {} of {}: expected a finite number, found {} (learning rate {})",
           state.iteration, what, trainable_.BlockName(static_cast<std::int64_t>(i)), values[i],
           state.learning_rate);
}

}  // namespace dexremoe
