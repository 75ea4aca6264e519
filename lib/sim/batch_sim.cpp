#include "sim/batch_sim.h"

#include <utility>

#include "base/error.h"
#include "sim/lanes/lanes_sim.h"
#include "sim/mujoco/mujoco_sim.h"
#include "sim/ode/ode_sim.h"

namespace dexremoe {

void SimOptions::Register(Options& options) {
  options.Add("sim.engine", &engine, "physics engine: lanes (fast), ode, or mujoco (to check)")
      .Choices({"ode", "lanes", "mujoco"});
  options.Add("sim.substeps", &substeps, "physics steps per control step").Range(1, 64);
  options.Add("sim.inner_steps", &inner_steps, "lanes: time steps per physics step").Range(1, 16);
  options.Add("sim.iterations", &iterations, "lanes: solver sweeps per time step").Range(1, 100);
  options.Add("sim.instructions", &instructions, "lanes: instruction set")
      .Choices({"auto", "avx512", "avx2", "sse4", "portable"});
  options.Add("sim.control_rate", &control_rate, "control steps per second, Hz").Range(1, 1000);
  options.Add("sim.gravity", &gravity, "gravity along the palm's normal, m/s^2").Range(-100, 100);
  options.Add("sim.max_contacts", &max_contacts, "ode: hand-object contact points kept")
      .Range(1, 64);
}

EnvState BatchSim::GetState(int env) const {
  const SimState& all = state();
  const std::size_t joints = num_joints();
  const auto vector = [&](const std::vector<double>& values) {
    return Eigen::Vector3d(&values[3 * static_cast<std::size_t>(env)]);
  };
  const auto row = [&](const std::vector<double>& values) {
    return std::vector<double>(values.begin() + env * joints, values.begin() + (env + 1) * joints);
  };
  const double* q = &all.object_rotation[4 * static_cast<std::size_t>(env)];
  EnvState one;
  one.q = row(all.joint_position);
  one.qd = row(all.joint_velocity);
  one.X_WO = {Eigen::Quaterniond(q[0], q[1], q[2], q[3]), vector(all.object_position)};
  one.v = vector(all.object_velocity);
  one.w = vector(all.object_spin);
  return one;
}

std::unique_ptr<BatchSim> MakeBatchSim(const SimOptions& options, const HandModel& hand,
                                       std::vector<SimObject> objects, int num_envs,
                                       ThreadPool& pool) {
  if (objects.empty()) Fail("simulator: expected at least one object");
  if (num_envs < 1) Fail("simulator: expected at least one environment, found {}", num_envs);
  if (options.engine == "ode") return MakeOdeSim(options, hand, std::move(objects), num_envs, pool);
  if (options.engine == "lanes")
    return MakeLanesSim(options, hand, std::move(objects), num_envs, pool);
  if (options.engine == "mujoco")
    return MakeMujocoSim(options, hand, std::move(objects), num_envs, pool);
  Fail("sim.engine: expected ode, lanes or mujoco, found '{}'", options.engine);
}

}  // namespace dexremoe
