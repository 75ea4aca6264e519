// How many control steps per second each engine makes on hands that hold objects: `bench_sim`.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/options.h"
#include "eval/sim_rollout.h"
#include "eval/sim_setting.h"
#include "eval/sim_table.h"

namespace dexremoe {

struct SimBenchOptions {
  int substeps = 2;          // of every engine in the comparison
  int rounds = 7;            // time slices of each setting in the comparison; elsewhere 3
  double slice = 0.25;       // s in BatchSim::Step per slice; at least one step
  double warm_up = 0.5;      // s in BatchSim::Step before, at most 20 steps
  int envs = 2048;           // lanes, where the number of environments is not what is studied
  int slow_envs = 256;       // ode, mujoco
  int max_envs = 32768;      // lanes
  int max_slow_envs = 8192;  // ode, mujoco
  int max_objects = 150;
  double noise = 0.5;  // of the random targets, see TargetWalk
  std::uint64_t seed = 1;
  void Register(Options& options);  // without a section
  void MakeQuick();                 // sizes that take seconds
};

// One engine rolling on, timed slice by slice.
class TimedRollout {
 public:
  // `hand` and `task` must outlive it.
  TimedRollout(const SimBenchOptions& options, const EngineSetting& setting, const HandModel& hand,
               const TaskOptions& task, const std::vector<GraspedObject>& objects, int num_envs,
               int workers);

  void WarmUp();
  void RunSlice();  // about options.slice seconds
  const std::string& label() const { return label_; }
  // Env-steps per second of each slice: by the clock, and per second of processor time, which other
  // programs on the machine disturb less.
  const std::vector<double>& wall_rates() const { return wall_rates_; }
  const std::vector<double>& cpu_rates() const { return cpu_rates_; }
  double contacts() const;       // hand-object contact points per environment, mean over the slices
  double episode_steps() const;  // control steps per fall, over all environments; NaN without falls

 private:
  SimBenchOptions options_;
  std::string label_;
  ThreadPool pool_;
  RandomRollout rollout_;
  std::vector<double> wall_rates_, cpu_rates_;
  double contacts_ = 0;
  double env_steps_ = 0;
  std::int64_t first_falls_ = 0;
};

// Warms all up, then gives each a slice in turn, `rounds` times: whatever slows the machine down
// for a while slows all of them.
void RunInterleaved(const std::vector<std::unique_ptr<TimedRollout>>& rollouts, int rounds);

struct Spread {
  double median = 0, low = 0, high = 0;  // low, high: over all values
};
Spread SpreadOf(std::vector<double> values);
// Of the ratios a[i] / b[i]; equally many, at least one.
Spread RatioOf(const std::vector<double>& a, const std::vector<double>& b);

// Bytes that one more environment takes on the heap.
double HeapBytesPerEnv(const EngineSetting& setting, const HandModel& hand,
                       const SimObject& object);

struct SimBenchResult {
  std::vector<Measurement> measurements;
  std::string notes;             // engines left out, one a line
  std::string Markdown() const;  // all tables and how to read them
};

// Measures everything: the comparison with its ratios, the settings of lanes, the numbers of
// environments, objects and workers, memory. `workers` is the larger number of threads tried beside
// 1 (0: one per processor).
SimBenchResult RunSimBench(const SimBenchOptions& options, const HandModel& hand,
                           const TaskOptions& task, int workers);

}  // namespace dexremoe
