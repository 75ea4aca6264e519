#include "task/task_state.h"

#include "base/error.h"

namespace dexremoe::internal {
namespace {

// One list of the arrays for every use; `visit` gets each in turn.
template <typename State, typename Visit>
void ForEachArray(State& s, Visit&& visit) {
  visit(s.object), visit(s.grasp), visit(s.length), visit(s.successes), visit(s.goals);
  visit(s.held), visit(s.waited), visit(s.episode), visit(s.live);
  visit(s.total_reward), visit(s.total_angle), visit(s.total_distance);
  visit(s.average), visit(s.target), visit(s.q), visit(s.qd), visit(s.position), visit(s.rotation);
  visit(s.goal), visit(s.angle), visit(s.distance), visit(s.gravity), visit(s.obs), visit(s.phys);
  if (!s.random.empty()) visit(s.random), visit(s.last_action), visit(s.force);
}

// Options that curricula and randomisation change while running.
template <typename Opts, typename Number, typename List>
void ForEachOption(Opts& o, Number&& number, List&& list) {
  number(o.tolerance), number(o.goal_angle), number(o.velocity_tolerance), number(o.hold_steps);
  number(o.gravity_factor), number(o.near_share);
  number(o.c_progress), number(o.c_fall), number(o.c_jam);
  list(o.mass_range), list(o.friction_range), list(o.torsion_range), list(o.com_range);
}

template <typename Record, typename Visit>
void ForEachField(Record& r, Visit&& visit) {
  visit(r.env), visit(r.object), visit(r.episode), visit(r.length), visit(r.successes);
  visit(r.end), visit(r.total_reward), visit(r.mean_angle), visit(r.mean_distance);
  visit(r.bound);
}

}  // namespace

void TaskState::Resize(int num_envs, int joints, int phys_size) {
  const std::size_t n = num_envs, j = joints;
  for (auto* counts : {&object, &grasp, &length, &successes, &goals, &held, &waited})
    counts->assign(n, 0);
  episode.assign(n, 0);
  live.assign(n, 1);
  for (auto* sums : {&total_reward, &total_angle, &total_distance, &angle, &distance, &gravity})
    sums->assign(n, 0.0);
  for (auto* rows : {&average, &target, &q, &qd}) rows->assign(n * j, 0.0);
  position.assign(n * 3, 0.0);
  rotation.assign(n * 4, 0.0);
  goal.assign(n, {1, 0, 0, 0});
  obs.assign(n * 6 * j, 0.0f);
  phys.assign(n * phys_size, 0.0f);
}

void TaskState::ResizeRandom(int num_envs, int joints) {
  const std::size_t n = num_envs;
  random.assign(n * kNumRandom, 0.0);
  last_action.assign(n * joints, 0.0);
  force.assign(n * 3, 0.0);
}

void TaskState::Save(ByteWriter& out) const {
  ForEachArray(*this, [&](const auto& array) { out.PutVector(array); });
}

void TaskState::Restore(ByteReader& in) {
  ForEachArray(*this, [&](auto& array) {
    using Vector = std::remove_reference_t<decltype(array)>;
    Vector read = in.GetVector<typename Vector::value_type>();
    if (read.size() != array.size())
      Fail("saved state: task: expected {} values, found {} (another batch)", array.size(),
           read.size());
    array = std::move(read);
  });
}

void SaveOptions(const TaskOptions& options, ByteWriter& out) {
  ForEachOption(
      options, [&](const auto& number) { out.Put(number); },
      [&](const std::vector<double>& list) { out.PutVector(list); });
}

void RestoreOptions(ByteReader& in, TaskOptions& options) {
  ForEachOption(
      options, [&](auto& number) { in.GetInto(number); },
      [&](std::vector<double>& list) { list = in.GetVector<double>(); });
}

void SaveRecords(const std::vector<EpisodeRecord>& records, ByteWriter& out) {
  out.Put(static_cast<std::uint64_t>(records.size()));
  for (const EpisodeRecord& record : records)
    ForEachField(record, [&](const auto& field) { out.Put(field); });
}

std::vector<EpisodeRecord> RestoreRecords(ByteReader& in) {
  std::vector<EpisodeRecord> records;
  for (auto left = in.Get<std::uint64_t>(); left > 0; --left)
    ForEachField(records.emplace_back(), [&](auto& field) { in.GetInto(field); });
  return records;
}

}  // namespace dexremoe::internal
