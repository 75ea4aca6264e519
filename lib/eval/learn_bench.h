// How fast policies learn: rollout inference, update and whole iterations against the machine's
// peak and against libtorch: `bench_learn`.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/options.h"
#include "eval/learn_bench_machine.h"
#include "eval/sim_bench.h"
#include "eval/sim_table.h"
#include "nn/precision.h"
#include "policy/structure.h"
#include "rl/ppo_options.h"

namespace dexremoe {

// One size to measure.
struct LearnBenchCase {
  PpoOptions ppo;
  int slices = 1;
  bool compare = false;  // with the peer
  bool paper = false;    // the paper's iteration
};

struct LearnBenchOptions {
  std::vector<std::string> precision = NativePrecisions();
  std::vector<int> envs = {512, 2048, 8192, 32768};
  int mini_epochs = 3;
  std::vector<int> more_epochs = {1, 5};
  int more_epochs_envs = 2048;
  bool paper = true;
  int horizon = PpoOptions().horizon;
  int minibatch = PpoOptions().minibatch;  // rows; at most those of a batch
  int hidden = PolicyOptions().hidden;
  int slices = 3;                                    // of every part, taken in turn
  double slice = 0.5;                                // s; at least one iteration
  std::string peer;                                  // program that times the update on libtorch
  std::vector<double> assumed_peaks = {1270, 2000};  // GFLOP/s
  std::uint64_t seed = 1;
  void Register(Options& options);  // without a section
  void MakeQuick();                 // sizes that take seconds

  // Each precision's cases together: `envs` with `mini_epochs`, compared with the peer;
  // `more_epochs`; the paper's iteration, once.
  std::vector<LearnBenchCase> Cases() const;
  // What the learner is made with: the place for every choice that changes how it computes.
  PpoOptions Ppo(int num_envs, int epochs, const std::string& in_precision) const;
  PolicyOptions Policy() const;
};

// Seconds per unit of work, slice by slice.
struct SliceTimes {
  std::vector<double> wall, cpu;  // by the clock; processor time of all threads
  void Add(const Cost& cost, int count);
};

// work / seconds of every slice.
std::vector<double> RatesOf(double work, const std::vector<double>& seconds);

// Training on the lanes engine with the object in every hand, timed slice by slice.
class TimedTraining {
 public:
  // `hand`, `task` and `pool` must outlive it.
  TimedTraining(const PpoOptions& ppo, const PolicyOptions& policy, const HandModel& hand,
                const TaskOptions& task, const GraspedObject& object, std::uint64_t seed,
                ThreadPool& pool);
  ~TimedTraining();

  // One iteration that counts nowhere.
  void WarmUp();
  // At least one iteration and `seconds` of them; then the same of forward passes alone.
  void RunSlice(double seconds);

  double samples() const;  // of an iteration
  const ParamLayout& layout() const;
  const SliceTimes& forward() const;    // per forward pass of all environments
  const SliceTimes& update() const;     // per iteration
  const SliceTimes& iteration() const;  // rollout and update

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

struct LearnBenchResult {
  std::vector<Measurement> measurements;
  std::string notes;   // what was left out, and with what the peer computes; one a line
  std::string limits;  // paragraphs: what the machine's peak would allow, and others would
  std::string Markdown() const;
};

// Measures options.Cases() on `workers` threads (0: one per processor). Throws Error when no cube
// can be held, when the processor lacks a precision, or when the peer fails or has another network.
LearnBenchResult RunLearnBench(const LearnBenchOptions& options, const HandModel& hand,
                               const TaskOptions& task, int workers);

}  // namespace dexremoe
