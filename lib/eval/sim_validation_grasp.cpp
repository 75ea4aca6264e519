// What becomes of grasps: at rest, and under random targets.
#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "eval/sim_validation.h"
#include "task/rotation.h"

namespace dexremoe {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

Vector3d PositionAt(const SimState& state, int env) {
  return Vector3d(&state.object_position[3 * static_cast<std::size_t>(env)]);
}

Quaterniond RotationAt(const SimState& state, int env) {
  const double* q = &state.object_rotation[4 * static_cast<std::size_t>(env)];
  return Quaterniond(q[0], q[1], q[2], q[3]).normalized();
}

// Value below which the share lies; `values` are reordered.
double Quantile(std::vector<double>& values, double share) {
  if (values.empty()) return NAN;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * (values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Sums of the squared speeds of every object.
class Restlessness {
 public:
  explicit Restlessness(int envs) : speed_(envs), spin_(envs) {}
  void Add(const SimState& before, const SimState& now, double rate) {
    for (std::size_t env = 0; env < speed_.size(); ++env) {
      const double v = (PositionAt(now, env) - PositionAt(before, env)).norm() * rate;
      const double w = RotationDistance(RotationAt(now, env), RotationAt(before, env)) * rate;
      speed_[env] += v * v;
      spin_[env] += w * w;
    }
    ++steps_;
  }
  bool Quiet(int env, const TaskOptions& task) const {
    return std::sqrt(speed_[env] / steps_) < task.speed_max &&
           std::sqrt(spin_[env] / steps_) < task.spin_max;
  }

 private:
  std::vector<double> speed_, spin_;
  int steps_ = 0;
};

}  // namespace

void HoldFigures::Add(const HoldFigures& other) {
  tried += other.tried;
  held += other.held;
  quiet += other.quiet;
}

HoldFigures HoldGrasps(const SimOptions& sim_options, const HandModel& hand,
                       const TaskOptions& task, const GraspedObject& object, double friction,
                       ThreadPool& pool) {
  constexpr double kSlip = 0.03;  // m
  HoldFigures figures;
  figures.tried = static_cast<int>(object.grasps.size());
  if (figures.tried == 0) return figures;
  const auto sim = MakeBatchSim(sim_options, hand, {object.sim}, figures.tried, pool);
  EnvPhysics physics = NominalPhysics(task, sim_options);
  physics.friction = friction;
  std::vector<double> targets;
  for (int env = 0; env < figures.tried; ++env) {
    const Grasp& grasp = object.grasps[env];
    PlaceGrasp(*sim, env, 0, grasp, physics);
    targets.insert(targets.end(), grasp.target.begin(), grasp.target.end());
  }
  const int steps = static_cast<int>(std::lround(sim_options.control_rate));
  Restlessness restlessness(figures.tried);
  for (int step = 0; step < steps; ++step) {
    const SimState before = sim->state();
    sim->Step(targets);
    if (2 * step >= steps) restlessness.Add(before, sim->state(), sim_options.control_rate);
  }
  for (int env = 0; env < figures.tried; ++env) {
    if ((PositionAt(sim->state(), env) - object.grasps[env].X_WO.p).norm() > kSlip) continue;
    ++figures.held;
    figures.quiet += restlessness.Quiet(env, task);
  }
  return figures;
}

SurvivalFigures Survive(const SimOptions& sim_options, const HandModel& hand,
                        const TaskOptions& task, const GraspedObject& object,
                        const SimValidationOptions& options, ThreadPool& pool) {
  DEX_CHECK(!object.grasps.empty());
  const int envs = options.episodes;
  const auto sim = MakeBatchSim(sim_options, hand, {object.sim}, envs, pool);
  TargetWalk walk(hand, task, options.noise, options.seed, envs);
  const EnvPhysics physics = NominalPhysics(task, sim_options);
  for (int env = 0; env < envs; ++env) {
    const Grasp& grasp = object.grasps[env % object.grasps.size()];
    PlaceGrasp(*sim, env, 0, grasp, physics);
    walk.Start(env, env, grasp);
  }
  std::vector<double> lengths(envs, 0.0), depths;
  std::vector<std::uint8_t> active(envs, 1);
  for (int step = 0, left = envs; step < task.episode_length && left > 0; ++step) {
    for (int env = 0; env < envs; ++env)
      if (active[env]) walk.Advance(env, sim->state());
    sim->Step(walk.targets(), active);
    for (int env = 0; env < envs; ++env) {
      if (!active[env]) continue;
      ++lengths[env];
      if (sim->state().contact_count[env] > 0) depths.push_back(sim->state().max_penetration[env]);
      if (GraspDistance(sim->state(), env, task) > options.fall_distance) active[env] = 0, --left;
    }
  }
  SurvivalFigures figures;
  double square = 0;
  for (const double length : lengths) figures.steps += length / envs;
  for (const double length : lengths) square += std::pow(length - figures.steps, 2) / envs;
  figures.error = std::sqrt(square / envs);
  figures.depth_95 = Quantile(depths, 0.95);
  figures.depth_99 = Quantile(depths, 0.99);
  figures.depth_max = Quantile(depths, 1);
  return figures;
}

}  // namespace dexremoe
