#include "eval/sim_rollout.h"

#include <algorithm>
#include <chrono>
#include <ctime>

#include "base/check.h"
#include "base/error.h"

namespace dexremoe {
namespace {

std::vector<SimObject> BodiesOf(const std::vector<GraspedObject>& objects) {
  std::vector<SimObject> bodies;
  for (const GraspedObject& object : objects) bodies.push_back(object.sim);
  return bodies;
}

std::vector<std::vector<Grasp>> GraspListsOf(const std::vector<GraspedObject>& objects) {
  std::vector<std::vector<Grasp>> lists;
  for (const GraspedObject& object : objects) {
    if (object.grasps.empty()) Fail("{}: expected at least one grasp", object.sim.name);
    lists.push_back(object.grasps);
  }
  return lists;
}

// Processor time of all threads of this process, s.
double ProcessorTime() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

std::vector<Grasp> GraspsOf(const SimObject& object, const GraspOptions& options,
                            const TaskOptions& task, const SimOptions& sim, const HandModel& hand,
                            std::uint64_t seed, ThreadPool& pool) {
  GraspCounts counts;
  return TryFindGrasps(options, task, sim, hand, object, seed, pool, &counts).grasps;
}

void PlaceGrasp(BatchSim& sim, int env, int object, const Grasp& grasp, const EnvPhysics& physics) {
  sim.SetObject(env, object, physics);
  sim.SetState(env, {grasp.q, std::vector<double>(grasp.q.size(), 0.0), grasp.X_WO});
  sim.SetHeld(env, false);
}

double GraspDistance(const SimState& state, int env, const TaskOptions& task) {
  const Eigen::Vector3d p(&state.object_position[3 * static_cast<std::size_t>(env)]);
  return (p - Eigen::Vector3d(task.grasp_center.data())).norm();
}

EnvPhysics NominalPhysics(const TaskOptions& task, const SimOptions& sim) {
  EnvPhysics physics;
  physics.mass = (task.mass_range[0] + task.mass_range[1]) / 2;
  physics.friction = (task.friction_range[0] + task.friction_range[1]) / 2;
  physics.torsional_friction = (task.torsion_range[0] + task.torsion_range[1]) / 2;
  physics.gravity = {0, 0, sim.gravity};
  return physics;
}

TargetWalk::TargetWalk(const HandModel& hand, const TaskOptions& task, double noise,
                       std::uint64_t seed, int num_envs)
    : hand_(hand), task_(task), noise_(noise), seed_(seed) {
  targets_.resize(static_cast<std::size_t>(num_envs) * hand.num_joints());
  rng_.assign(num_envs, Rng(0));
}

void TargetWalk::Start(int env, std::uint64_t episode, const Grasp& grasp) {
  rng_[env] = Rng(seed_, Stream::kAction, {episode});
  std::copy(grasp.target.begin(), grasp.target.end(),
            targets_.begin() + static_cast<std::ptrdiff_t>(env) * hand_.num_joints());
}

void TargetWalk::Advance(int env, const SimState& state) {
  const std::size_t row = static_cast<std::size_t>(env) * hand_.num_joints();
  for (int j = 0; j < hand_.num_joints(); ++j) {
    const double action = std::clamp(noise_ * rng_[env].Normal(), -1.0, 1.0);
    const double q = state.joint_position[row + j];
    double& target = targets_[row + j];
    target = std::clamp(target + task_.action_scale * action, q - task_.target_leash,
                        q + task_.target_leash);
    target = std::clamp(target, hand_.joints[j].lower, hand_.joints[j].upper);
  }
}

RandomRollout::RandomRollout(const SimOptions& sim, const HandModel& hand, const TaskOptions& task,
                             const std::vector<GraspedObject>& objects, int num_envs, double noise,
                             std::uint64_t seed, ThreadPool& pool)
    : task_(task),
      grasps_(GraspListsOf(objects)),
      sim_(MakeBatchSim(sim, hand, BodiesOf(objects), num_envs, pool)),
      walk_(hand, task, noise, seed, num_envs),
      physics_(NominalPhysics(task, sim)) {
  for (int env = 0; env < num_envs; ++env) episode_.push_back(env);
  for (int env = 0; env < num_envs; ++env) Restart(env);
}

void RandomRollout::Restart(int env) {
  const int object = env % static_cast<int>(grasps_.size());
  const std::vector<Grasp>& grasps = grasps_[object];
  const Grasp& grasp = grasps[episode_[env] / grasps_.size() % grasps.size()];
  PlaceGrasp(*sim_, env, object, grasp, physics_);
  walk_.Start(env, episode_[env], grasp);
  episode_[env] += sim_->num_envs();
}

RandomRollout::Cost RandomRollout::Step() {
  const int envs = sim_->num_envs();
  for (int env = 0; env < envs; ++env) walk_.Advance(env, sim_->state());
  const auto start = std::chrono::steady_clock::now();
  const double cpu = ProcessorTime();
  sim_->Step(walk_.targets());
  const Cost cost = {
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
      ProcessorTime() - cpu};
  for (int env = 0; env < envs; ++env)
    if (GraspDistance(sim_->state(), env, task_) > task_.fall_distance) Restart(env), ++falls_;
  return cost;
}

}  // namespace dexremoe
