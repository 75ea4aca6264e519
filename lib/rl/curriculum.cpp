#include "rl/curriculum.h"

#include <algorithm>
#include <numbers>

namespace dexremoe {

Curriculum::Curriculum(const PpoOptions& options, const TaskDifficulty& task, int objects)
    : options_(options), task_(task), objects_(objects) {}

CurriculumState Curriculum::Start() const {
  CurriculumState state;
  TaskDifficulty& first = state.difficulty = task_;
  if (options_.curriculum) {
    first.goal_angle = std::min(options_.goal_angle_start, task_.goal_angle);
    first.velocity_tolerance = std::max(options_.velocity_start, task_.velocity_tolerance);
    first.gravity_factor = std::min(options_.gravity_start, task_.gravity_factor);
    first.objects = std::min(options_.curriculum_objects, objects_);
  }
  Complete(0, first);
  return state;
}

bool Curriculum::AngleOpen(const TaskDifficulty& now) const {
  return now.goal_angle < std::min(task_.goal_angle, std::numbers::pi);
}

bool Curriculum::VelocityOpen(const TaskDifficulty& now) const {
  return now.velocity_tolerance > task_.velocity_tolerance;
}

void Curriculum::Complete(std::int64_t samples, TaskDifficulty& now) const {
  const bool open = options_.curriculum && (AngleOpen(now) || VelocityOpen(now));
  now.near_share =
      open && options_.near_share_start >= 0 ? options_.near_share_start : task_.near_share;
  now.fall_share = options_.FallShare(samples);
}

bool Curriculum::Update(std::int64_t samples, const std::vector<EpisodeRecord>& records,
                        CurriculumState& state) const {
  if (!options_.curriculum) return false;
  state.samples += samples;
  for (const EpisodeRecord& record : records) {
    ++state.episodes;
    state.successes += record.successes;
  }
  if (static_cast<double>(state.samples) < options_.curriculum_period || state.episodes == 0)
    return false;
  const double rate = static_cast<double>(state.successes) / static_cast<double>(state.episodes);
  state.samples = state.episodes = state.successes = 0;
  return rate > options_.curriculum_threshold && Advance(state);
}

// Gravity rises with every advance. Of goals and speeds the one moves whose turn it is, or the
// other when that one has arrived; then come the objects.
bool Curriculum::Advance(CurriculumState& state) const {
  TaskDifficulty& now = state.difficulty;
  const bool gravity_open = now.gravity_factor < task_.gravity_factor;
  const bool angle_open = AngleOpen(now), velocity_open = VelocityOpen(now);
  now.gravity_factor = std::min(now.gravity_factor + options_.gravity_step, task_.gravity_factor);
  if (!angle_open && !velocity_open) {
    if (gravity_open) return true;
    if (now.objects == 0 || now.objects == objects_) return false;
    now.objects = std::min(2 * now.objects, objects_);
    return true;
  }
  const bool move_angle = angle_open && (state.angle_next || !velocity_open);
  if (move_angle)
    now.goal_angle = std::min(now.goal_angle * options_.goal_angle_factor, task_.goal_angle);
  else
    now.velocity_tolerance =
        std::max(now.velocity_tolerance * options_.velocity_factor, task_.velocity_tolerance);
  state.angle_next = !move_angle;
  return true;
}

}  // namespace dexremoe
