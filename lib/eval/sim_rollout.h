// Hands that hold objects while their joint targets move at random: the load on which engines are
// timed and on which they must agree.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/random.h"
#include "sim/batch_sim.h"
#include "task/grasp_search.h"
#include "task/reorient.h"

namespace dexremoe {

struct GraspedObject {
  SimObject sim;
  std::vector<Grasp> grasps;
};

// Grasps of one object at scale 1. Empty when none of the candidates holds.
std::vector<Grasp> GraspsOf(const SimObject& object, const GraspOptions& options,
                            const TaskOptions& task, const SimOptions& sim, const HandModel& hand,
                            std::uint64_t seed, ThreadPool& pool);

// Puts `object` into the hand of env as the grasp says, everything at rest.
void PlaceGrasp(BatchSim& sim, int env, int object, const Grasp& grasp, const EnvPhysics& physics);

// Joint targets that wander as under a policy before training: each control step every target
// moves by task.action_scale * clamp(noise * N(0,1), -1, 1) and stays within task.target_leash of
// its joint and within the joint's limits. The numbers of an episode come from (seed, episode).
class TargetWalk {
 public:
  TargetWalk(const HandModel& hand, const TaskOptions& task, double noise, std::uint64_t seed,
             int num_envs);

  void Start(int env, std::uint64_t episode, const Grasp& grasp);
  void Advance(int env, const SimState& state);
  const std::vector<double>& targets() const { return targets_; }  // [N,J] rad

 private:
  const HandModel& hand_;
  const TaskOptions& task_;
  double noise_;
  std::uint64_t seed_;
  std::vector<double> targets_;
  std::vector<Rng> rng_;
};

// A batch that rolls on: an environment whose object fell gets a grasp again, as in training.
// Environment e holds object e % objects.size().
class RandomRollout {
 public:
  // Every object needs a grasp. `hand`, `task` and `pool` must outlive the rollout.
  RandomRollout(const SimOptions& sim, const HandModel& hand, const TaskOptions& task,
                const std::vector<GraspedObject>& objects, int num_envs, double noise,
                std::uint64_t seed, ThreadPool& pool);

  struct Cost {
    double wall = 0, cpu = 0;  // s, within BatchSim::Step alone
  };
  // One control step of all environments.
  Cost Step();

  const BatchSim& sim() const { return *sim_; }
  BatchSim& sim() { return *sim_; }
  std::int64_t falls() const { return falls_; }

 private:
  void Restart(int env);

  const TaskOptions& task_;
  const std::vector<std::vector<Grasp>> grasps_;
  std::unique_ptr<BatchSim> sim_;
  TargetWalk walk_;
  std::vector<std::uint64_t> episode_;
  EnvPhysics physics_;
  std::int64_t falls_ = 0;
};

// Distance of the object of env from task.grasp_center, m.
double GraspDistance(const SimState& state, int env, const TaskOptions& task);

// The middle of task.mass_range, task.friction_range and task.torsion_range under sim.gravity.
EnvPhysics NominalPhysics(const TaskOptions& task, const SimOptions& sim);

}  // namespace dexremoe
