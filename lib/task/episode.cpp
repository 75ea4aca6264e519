#include "task/episode.h"

#include "base/error.h"
#include "task/goal.h"

namespace dexremoe::internal {
namespace {

double Draw(Rng& rng, const std::vector<double>& range) { return rng.Uniform(range[0], range[1]); }

}  // namespace

// FNV-1a.
std::uint64_t ObjectKey(const std::string& name) {
  std::uint64_t hash = 14695981039346656037ull;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  return hash;
}

EpisodeStart DrawStart(const TaskOptions& options, const TaskObject& object, double gravity,
                       std::uint64_t seed, const EpisodeKey& key) {
  EpisodeStart start;
  Rng reset(seed, Stream::kReset, {key.object, key.episode});
  start.grasp = static_cast<int>(reset.Index(object.grasps.size()));
  Rng rng(seed, Stream::kPhysical, {key.object, key.episode});
  EnvPhysics& physics = start.physics;
  // NOTE(paper): neither ranges nor nominal values of mass, friction and centre of mass are given.
  physics.mass = Draw(rng, options.mass_range);
  physics.friction = Draw(rng, options.friction_range);
  for (double& c : physics.com) c = Draw(rng, options.com_range);
  physics.torsional_friction = Draw(rng, options.torsion_range);
  physics.scale = object.grasps[start.grasp].scale;
  physics.gravity = {0, 0, gravity};
  return start;
}

Eigen::Quaterniond DrawEpisodeGoal(const TaskOptions& options, const Eigen::Quaterniond& q_WO,
                                   std::uint64_t seed, const EpisodeKey& key, int number) {
  Rng rng(seed, Stream::kGoal, {key.object, key.episode, static_cast<std::uint64_t>(number)});
  return DrawGoal(rng, q_WO, options.tolerance, options.goal_angle);
}

void CheckStarts(const TaskOptions& options, const HandModel& hand, const TaskObject& object) {
  if (object.grasps.empty()) Fail("{}: grasps: expected at least one, found none", object.name);
  const std::size_t joints = hand.joints.size();
  const double low = options.scale * options.scale_range[0] - 1e-9;
  const double high = options.scale * options.scale_range[1] + 1e-9;
  for (const Grasp& g : object.grasps) {
    if (g.q.size() != joints || g.target.size() != joints)
      Fail("{}: grasps: expected {} joints, found {}", object.name, joints, g.q.size());
    if (!(g.scale >= low && g.scale <= high))
      Fail(
          "{}: grasps: expected scale in {}..{} (task.scale, task.scale_range), found {}: run "
          "find_grasps with these options",
          object.name, low + 1e-9, high - 1e-9, g.scale);
  }
}

}  // namespace dexremoe::internal
