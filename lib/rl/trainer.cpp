#include "rl/trainer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "base/bytes.h"
#include "base/check.h"
#include "rl/rank_statistics.h"

namespace dexremoe {
namespace {

double Seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Means over the window of ended episodes. NaN until an episode has ended.
struct WindowMeans {
  double successes = NAN, per_600 = NAN, drops = NAN, distance = NAN, angle = NAN, length = NAN,
         reward = NAN;
};

WindowMeans MeansOf(const std::vector<EpisodeRecord>& window) {
  WindowMeans means;
  if (window.empty()) return means;
  double successes = 0, drops = 0, steps = 0, distance = 0, angle = 0, reward = 0;
  for (const EpisodeRecord& record : window) {
    successes += record.successes;
    drops += record.end == EpisodeEnd::kFall;
    steps += record.length;
    distance += record.mean_distance * record.length;
    angle += record.mean_angle * record.length;
    reward += record.total_reward;
  }
  const double n = static_cast<double>(window.size());
  means.successes = successes / n;
  means.per_600 = 600 * successes / steps;
  means.drops = drops / n;
  means.distance = distance / steps;
  means.angle = angle / steps;
  means.length = steps / n;
  means.reward = reward / n;
  return means;
}

}  // namespace

Trainer::Trainer(const PpoOptions& options, const TaskDifficulty& task, TrainState state,
                 VecEnv& env, ThreadPool& pool, Communicator& communicator, const AdrOptions& adr)
    : options_(options),
      adr_(adr),
      state_(std::move(state)),
      env_(env),
      communicator_(communicator),
      policy_(MakePolicy<float>(state_.structure)),
      curriculum_(options, task, state_.table.objects()) {
  DEX_CHECK_EQ(static_cast<std::int64_t>(state_.params.size()), policy_->layout().size());
  if (options_.stats_window == 0) options_.stats_window = env.num_envs() * communicator.size();
  shapes_ = std::make_unique<ShapeRows>(state_.table, state_.normalizers.feature,
                                        state_.normalizers.clip, state_.structure.num_categories);
  rollout_ = std::make_unique<Rollout>(options_, *policy_, env, pool);
  learner_ = std::make_unique<PpoLearner>(options_, *policy_, pool, communicator);
  const bool resumed = !state_.environment.empty();
  if (resumed) {
    DEX_CHECK_EQ(static_cast<int>(state_.environment.size()), communicator.size());
    env_.Restore(state_.environment[communicator.rank()]);
  }
  SetDifficulty();
  if (adr_.on) {
    if (state_.adr.empty()) state_.adr = StartAdr();
    env_.SetRandomRanges(state_.adr.low, state_.adr.high);
  }
  if (!resumed) env_.ResetAll();
}

Trainer::~Trainer() = default;

const CurveRow& Trainer::Iterate() {
  const double start = Seconds();
  state_.environment.clear();  // out of date from here on
  // Ranks on other processors may round an update otherwise: they start each iteration as one.
  communicator_.Broadcast(std::as_writable_bytes(std::span(state_.params)));
  const bool learn_moments = state_.structure.train_encoders;
  RunningMoments obs = EmptyMoments(env_.obs_size()), phys = EmptyMoments(env_.phys_size());
  const RolloutBatch& batch = rollout_->Collect(
      state_, shapes_->inputs(), learn_moments ? &obs : nullptr, learn_moments ? &phys : nullptr);
  const double middle = Seconds();
  const double rate = state_.learning_rate;
  const UpdateStats stats = learner_->Update(batch, shapes_->inputs(), state_);
  MergeMoments(communicator_, obs, state_.normalizers.obs);
  MergeMoments(communicator_, phys, state_.normalizers.phys);
  time_ = {middle - start, Seconds() - middle};

  const std::vector<EpisodeRecord> records = RecordsOfAllRanks(batch.records);
  const std::int64_t samples =
      static_cast<std::int64_t>(batch.steps) * batch.envs * communicator_.size();
  ++state_.iteration;
  state_.samples += samples;
  AddRecords(records);
  state_.curve.push_back(MakeRow(stats, rate));
  Judge();
  if (curriculum_.Update(samples, records, state_.curriculum)) state_.settled = 0;
  SetDifficulty();
  if (adr_.on && UpdateAdr(adr_, records, state_.samples, state_.adr))
    env_.SetRandomRanges(state_.adr.low, state_.adr.high);
  return state_.curve.back();
}

const TrainState& Trainer::Snapshot() {
  state_.environment = communicator_.Gather(env_.Save());
  return state_;
}

void Trainer::SetDifficulty() {
  curriculum_.Complete(state_.samples, state_.curriculum.difficulty);
  env_.SetDifficulty(state_.curriculum.difficulty);
}

void Trainer::Judge() {
  improved_ = false;
  // The first episodes that end after a change were begun before it, one an environment.
  const int begun_before = env_.num_envs() * communicator_.size();
  if (state_.settled < begun_before + options_.stats_window) return;
  const TaskDifficulty& now = state_.curriculum.difficulty;
  const double share =
      now.objects > 0 ? static_cast<double>(now.objects) / state_.table.objects() : 1.0;
  const RunScore score = {
      share * std::min(now.goal_angle, std::numbers::pi) / now.velocity_tolerance +
          now.gravity_factor,
      MeansOf(state_.window).successes};
  improved_ = score > state_.best;
  if (improved_) state_.best = score;
}

std::vector<EpisodeRecord> Trainer::RecordsOfAllRanks(std::vector<EpisodeRecord> records) {
  for (EpisodeRecord& record : records) record.env += env_.first_env();
  ByteWriter own;
  own.PutVector(records);
  std::vector<EpisodeRecord> all;
  for (const std::vector<std::uint8_t>& bytes : communicator_.AllGather(own.Take())) {
    const auto part = ByteReader(bytes).GetVector<EpisodeRecord>();
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

void Trainer::AddRecords(const std::vector<EpisodeRecord>& records) {
  state_.settled += static_cast<std::int64_t>(records.size());
  std::vector<EpisodeRecord>& window = state_.window;
  window.insert(window.end(), records.begin(), records.end());
  const std::size_t limit = static_cast<std::size_t>(options_.stats_window);
  if (window.size() > limit) window.erase(window.begin(), window.end() - limit);
}

CurveRow Trainer::MakeRow(const UpdateStats& stats, double learning_rate) const {
  const WindowMeans means = MeansOf(state_.window);
  const ParamBlock& spread = policy_->layout().block(policy_->log_std_block());
  double log_std = 0;
  for (std::int64_t a = 0; a < spread.size(); ++a)
    log_std += state_.params[spread.offset + a] / static_cast<double>(spread.size());
  const TaskDifficulty& difficulty = state_.curriculum.difficulty;
  return {static_cast<double>(state_.iteration),
          static_cast<double>(state_.samples),
          means.successes,
          means.per_600,
          means.drops,
          means.distance,
          means.angle,
          means.length,
          means.reward,
          static_cast<double>(state_.window.size()),
          stats.kl,
          learning_rate,
          log_std,
          stats.policy_loss,
          stats.value_loss,
          stats.explained_variance,
          stats.clip_fraction,
          stats.gradient_norm,
          difficulty.goal_angle,
          difficulty.velocity_tolerance,
          difficulty.gravity_factor,
          static_cast<double>(difficulty.objects > 0 ? difficulty.objects : state_.table.objects()),
          stats.routing_entropy,
          stats.least_load,
          stats.most_load,
          stats.auxiliary_loss};
}

}  // namespace dexremoe
