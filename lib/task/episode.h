// How an episode begins, and the random streams behind it. Internal to lib/task.
#pragma once

#include <string>

#include "base/random.h"
#include "task/reorient.h"

namespace dexremoe::internal {

// What addresses the streams of an episode: independent of environment, batch and object list.
struct EpisodeKey {
  std::uint64_t object = 0;  // hash of the object's name
  std::uint64_t episode = 0;
};
std::uint64_t ObjectKey(const std::string& name);

struct EpisodeStart {
  int grasp = 0;
  EnvPhysics physics;
};
EpisodeStart DrawStart(const TaskOptions& options, const TaskObject& object, double gravity,
                       std::uint64_t seed, const EpisodeKey& key);

// Goal `number` (0, 1, ...) of the episode, drawn when the object is at q_WO.
Eigen::Quaterniond DrawEpisodeGoal(const TaskOptions& options, const Eigen::Quaterniond& q_WO,
                                   std::uint64_t seed, const EpisodeKey& key, int number);

// Throws Error when `object` cannot start an episode of this hand under these options.
void CheckStarts(const TaskOptions& options, const HandModel& hand, const TaskObject& object);

}  // namespace dexremoe::internal
