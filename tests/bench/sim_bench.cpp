// Physics: control steps per second of the whole hand holding a cube.
#include <benchmark/benchmark.h>

#include "base/thread_pool.h"
#include "hand/hand_model.h"
#include "sim/batch_sim.h"

namespace dexremoe {
namespace {

SimObject Cube(double side) {
  SimObject cube;
  cube.name = "cube";
  TriMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back(side *
                            Eigen::Vector3d((i & 1) - 0.5, (i >> 1 & 1) - 0.5, (i >> 2) - 0.5));
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  cube.parts = {mesh};
  cube.unit_inertia = Eigen::Matrix3d::Identity() * side * side / 6;
  cube.radius = side * 0.87;
  return cube;
}

// Fingers closed around a cube between the tips; targets squeeze a little (hand/FACTS: the cage
// around a 25 to 30 mm sphere).
void HeldCube(benchmark::State& bench) {
  const int substeps = static_cast<int>(bench.range(0));
  const int workers = static_cast<int>(bench.range(1));
  constexpr int kEnvs = 64, kStepsPerReset = 60;
  ThreadPool pool(workers);
  const HandModel hand = LoadHand({});
  SimOptions options;
  options.substeps = substeps;
  const auto sim = MakeBatchSim(options, hand, {Cube(0.05)}, kEnvs, pool);
  EnvState start;
  start.q = {1.658, 0.20, 0.25, 0.96, 0.08, 0.62, 0.08, 1.62, 0.46, -0.46, 0.13};
  start.qd.assign(start.q.size(), 0.0);
  start.X_WO.p = {0.01, 0.075, 0.125};
  std::vector<double> targets;
  for (int env = 0; env < kEnvs; ++env)
    for (std::size_t j = 0; j < start.q.size(); ++j)
      targets.push_back(start.q[j] + (j == 0 || j == 4 || j == 8 ? 0 : 0.12));
  long step = 0;
  double contacts = 0;
  for (auto _ : bench) {
    if (step++ % kStepsPerReset == 0)
      for (int env = 0; env < kEnvs; ++env) {
        sim->SetObject(env, 0, {});
        sim->SetState(env, start);
      }
    sim->Step(targets);
    for (const int count : sim->state().contact_count) contacts += count;
  }
  const double env_steps = static_cast<double>(bench.iterations()) * kEnvs;
  bench.counters["env_steps"] = benchmark::Counter(env_steps, benchmark::Counter::kIsRate);
  bench.counters["substeps"] =
      benchmark::Counter(env_steps * substeps, benchmark::Counter::kIsRate);
  bench.counters["contacts"] = contacts / env_steps;
}
BENCHMARK(HeldCube)
    ->ArgNames({"substeps", "workers"})
    ->ArgsProduct({{1, 2, 4}, {1, 2}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace dexremoe
