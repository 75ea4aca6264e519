// The tables of bench_sim.
#include <algorithm>
#include <thread>

#include "base/error.h"
#include "base/log.h"
#include "eval/sim_bench.h"
#include "eval/sim_scenes.h"
#include "sim/lanes/lanes_sim.h"

namespace dexremoe {
namespace {

using Rollouts = std::vector<std::unique_ptr<TimedRollout>>;

std::string Interval(const Spread& s, double unit, int decimals) {
  return fmt::format("[{:.{}f}, {:.{}f}]", s.low / unit, decimals, s.high / unit, decimals);
}

class Bench {
 public:
  Bench(const SimBenchOptions& options, const HandModel& hand, const TaskOptions& task, int workers)
      : options_(options), hand_(hand), task_(task) {
    workers_ = workers > 0 ? workers : static_cast<int>(std::thread::hardware_concurrency());
    engines_ = AvailableEngines(hand, &result_.notes);
  }

  SimBenchResult Run() {
    FindObjects();
    Compare();
    if (Has("lanes")) {
      CompareLanes();
      Phases();
    }
    for (const std::string& engine : engines_) {
      VaryEnvironments(engine);
      VaryObjects(engine);
      Memory(engine);
    }
    return std::move(result_);
  }

 private:
  bool Has(const std::string& engine) const {
    return std::find(engines_.begin(), engines_.end(), engine) != engines_.end();
  }
  EngineSetting Compared(const std::string& engine) const {
    return SettingOf(SimOptions(), engine, options_.substeps);
  }
  int EnvsOf(const std::string& engine) const {
    return engine == "lanes" ? options_.envs : options_.slow_envs;
  }
  int MaxEnvsOf(const std::string& engine) const {
    return engine == "lanes" ? options_.max_envs : options_.max_slow_envs;
  }

  // The cube, then random bodies; all with grasps that the quickest engine found.
  void FindObjects() {
    GraspOptions grasp;
    grasp.count = 8;
    grasp.candidates = 256;
    grasp.hold_steps = 20;
    const std::string engine = engines_.front();
    const SimOptions sim = SettingOf(SimOptions(), engine, engine == "lanes" ? 2 : 1).sim;
    ThreadPool pool(workers_);
    const auto add = [&](const SimObject& body) {
      auto grasps = GraspsOf(body, grasp, task_, sim, hand_, options_.seed, pool);
      if (!grasps.empty()) objects_.push_back({body, std::move(grasps)});
    };
    add(BoxObject("cube", Eigen::Vector3d::Constant(0.055)));
    if (objects_.empty()) Fail("cube: no grasp found by {}", engine);
    const int drawn = 2 * options_.max_objects;
    Progress progress("objects to hold", options_.max_objects);
    for (const SimObject& body : RandomCompounds(drawn, options_.seed)) {
      if (static_cast<int>(objects_.size()) >= options_.max_objects) break;
      add(body);
      progress.Update(static_cast<double>(objects_.size()));
    }
    progress.Finish();
    if (static_cast<int>(objects_.size()) < options_.max_objects)
      Fail("max_objects: expected {} objects that can be held, found {}", options_.max_objects,
           objects_.size());
  }

  // A rollout with objects first .. first + count - 1.
  void Add(Rollouts& rollouts, const EngineSetting& setting, int count, int envs, int workers,
           int first = 0) {
    LogInfo("{}: {} environments, objects: {}, workers: {}", setting.label, envs, count, workers);
    const auto begin = objects_.begin() + first;
    rollouts.push_back(std::make_unique<TimedRollout>(
        options_, setting, hand_, task_, std::vector<GraspedObject>(begin, begin + count), envs,
        workers));
  }

  void Record(const std::string& table, const std::string& row, const std::string& column,
              const Spread& spread, double unit, int decimals) {
    result_.measurements.push_back(
        {table, row, column, spread.median / unit, decimals, Interval(spread, unit, decimals)});
  }
  void Record(const std::string& table, const std::string& row, const std::string& column,
              double value, int decimals) {
    result_.measurements.push_back({table, row, column, value, decimals, ""});
  }
  // Of one thread by processor time, of several by the clock.
  void RecordRate(const std::string& table, const std::string& row, const std::string& column,
                  const TimedRollout& rollout, int workers = 1) {
    Record(table, row, column, SpreadOf(workers == 1 ? rollout.cpu_rates() : rollout.wall_rates()),
           1e3, 1);
  }

  // Lanes with every instruction set of this processor, then the other engines.
  void Compare() {
    Rollouts rollouts;
    std::size_t lanes = 0;
    for (const std::string& engine : engines_) {
      EngineSetting setting = Compared(engine);
      if (engine != "lanes") {
        Add(rollouts, setting, 1, EnvsOf(engine), 1);
        continue;
      }
      for (const std::string& instructions : LaneInstructions()) {
        setting.sim.instructions = instructions;
        setting.label = Compared(engine).label + " " + instructions;
        Add(rollouts, setting, 1, EnvsOf(engine), 1);
        ++lanes;
      }
    }
    RunInterleaved(rollouts, options_.rounds);
    for (const auto& rollout : rollouts) {
      const Spread cpu = SpreadOf(rollout->cpu_rates());
      Record("rate", rollout->label(), "1000 env-steps/s", SpreadOf(rollout->wall_rates()), 1e3, 1);
      Record("rate", rollout->label(), "per s of processor time", cpu, 1e3, 1);
      Record("rate", rollout->label(), "processor us per env-step", 1e6 / cpu.median, 2);
      Record("rate", rollout->label(), "contact points", rollout->contacts(), 2);
      Record("rate", rollout->label(), "steps per fall", rollout->episode_steps(), 0);
    }
    for (std::size_t l = 0; l < lanes; ++l)
      for (std::size_t i = lanes; i < rollouts.size(); ++i) RecordRatio(*rollouts[l], *rollouts[i]);
  }

  void RecordRatio(const TimedRollout& fast, const TimedRollout& slow) {
    const std::string row = fast.label() + " / " + slow.label();
    Record("ratio", row, "by the clock", RatioOf(fast.wall_rates(), slow.wall_rates()), 1, 1);
    Record("ratio", row, "by processor time", RatioOf(fast.cpu_rates(), slow.cpu_rates()), 1, 1);
  }

  // Substeps x inner steps x iterations, from coarse to fine.
  void CompareLanes() {
    constexpr int kSettings[][3] = {{1, 1, 5}, {1, 1, 10}, {1, 4, 3}, {2, 1, 5},
                                    {2, 2, 3}, {4, 1, 3},  {4, 1, 8}};
    Rollouts rollouts;
    for (const auto& s : kSettings)
      Add(rollouts, SettingOf(SimOptions(), "lanes", s[0], s[1], s[2]), 1, options_.envs, 1);
    RunInterleaved(rollouts, std::min(3, options_.rounds));
    for (const auto& rollout : rollouts) {
      RecordRate("lanes", rollout->label(), "1000 env-steps/s", *rollout);
      Record("lanes", rollout->label(), "steps per fall", rollout->episode_steps(), 0);
    }
  }

  void VaryEnvironments(const std::string& engine) {
    const EngineSetting setting = Compared(engine);
    std::vector<int> threads = {1};
    if (workers_ > 1) threads.push_back(workers_);
    for (const int workers : threads) {
      const std::string row = fmt::format("{}, workers: {}", setting.label, workers);
      Rollouts rollouts;
      std::vector<int> sizes;
      for (const int envs : {256, 2048, 8192})
        if (envs < MaxEnvsOf(engine)) sizes.push_back(envs);
      sizes.push_back(MaxEnvsOf(engine));
      for (const int envs : sizes) Add(rollouts, setting, 1, envs, workers);
      RunInterleaved(rollouts, std::min(3, options_.rounds));
      for (std::size_t i = 0; i < sizes.size(); ++i)
        RecordRate("environments", row, fmt::format("{}", sizes[i]), *rollouts[i], workers);
    }
  }

  // Many objects are compared with the cube and with single ones of their own kind, which may cost
  // more than the cube does.
  void VaryObjects(const std::string& engine) {
    const EngineSetting setting = Compared(engine);
    const int most = options_.max_objects, some = std::max(1, most / 10), envs = EnvsOf(engine);
    const int singles = std::min(8, most - 1);
    Rollouts rollouts;
    Add(rollouts, setting, 1, envs, 1);
    Add(rollouts, setting, some, envs, 1);
    Add(rollouts, setting, most, envs, 1);
    Add(rollouts, setting, most, MaxEnvsOf(engine), 1);
    for (int i = 1; i <= singles; ++i) Add(rollouts, setting, 1, envs, 1, i);
    RunInterleaved(rollouts, std::min(3, options_.rounds));
    RecordRate("objects", setting.label, "cube", *rollouts[0]);
    RecordRate("objects", setting.label, fmt::format("{} objects", some), *rollouts[1]);
    RecordRate("objects", setting.label, fmt::format("{} objects", most), *rollouts[2]);
    const TimedRollout& all = *rollouts[3];
    RecordRate("objects", setting.label, "most environments", all);
    Record("objects", setting.label, "over the cube",
           RatioOf(all.cpu_rates(), rollouts[0]->cpu_rates()), 1, 2);
    if (singles == 0) return;
    double seconds = 0;  // of processor time per env-step, mean over the single bodies
    for (int i = 0; i < singles; ++i)
      seconds += 1 / SpreadOf(rollouts[4 + i]->cpu_rates()).median / singles;
    Record("objects", setting.label, fmt::format("mean of {} alone", singles), 1e-3 / seconds, 1);
    Record("objects", setting.label, "over that mean", SpreadOf(all.cpu_rates()).median * seconds,
           2);
  }

  void Memory(const std::string& engine) {
    const EngineSetting setting = Compared(engine);
    Record("memory", setting.label, "heap bytes per environment",
           HeapBytesPerEnv(setting, hand_, objects_.front().sim), 0);
    if (engine != "lanes") return;
    ThreadPool pool(1);
    const auto sim = MakeBatchSim(setting.sim, hand_, {objects_.front().sim}, 1, pool);
    const LanesFootprint footprint = FootprintOf(*sim);
    Record("memory", setting.label, "state bytes per environment",
           static_cast<double>(footprint.bytes_per_env), 0);
    Record("memory", setting.label, "kilobytes per object",
           static_cast<double>(footprint.bytes_per_object) / 1024, 0);
    result_.notes += fmt::format("lanes runs {} environments per block with {} instructions.\n",
                                 footprint.lanes, footprint.instructions);
  }

  // Where the time of lanes goes, on one thread.
  void Phases() {
    constexpr int kSteps = 50;
    ThreadPool pool(1);
    const EngineSetting setting = Compared("lanes");
    RandomRollout rollout(setting.sim, hand_, task_, {objects_.front()}, options_.envs,
                          options_.noise, options_.seed, pool);
    for (int step = 0; step < kSteps; ++step) rollout.Step();
    StartProfile(rollout.sim());
    for (int step = 0; step < kSteps; ++step) rollout.Step();
    const LanesProfile profile = StopProfile(rollout.sim());
    for (std::size_t i = 0; i < profile.phases.size(); ++i)
      Record("phases", setting.label, profile.phases[i] + ", %", 100 * profile.shares[i], 1);
    Record("phases", setting.label, "contact slots a substep", profile.slots, 1);
    Record("phases", setting.label, "lanes busy in them, %", 100 * profile.occupancy, 1);
  }

  SimBenchOptions options_;
  const HandModel& hand_;
  const TaskOptions& task_;
  int workers_;
  std::vector<std::string> engines_;
  std::vector<GraspedObject> objects_;
  SimBenchResult result_;
};

}  // namespace

SimBenchResult RunSimBench(const SimBenchOptions& options, const HandModel& hand,
                           const TaskOptions& task, int workers) {
  return Bench(options, hand, task, workers).Run();
}

std::string SimBenchResult::Markdown() const {
  std::string text = "# Speed of the physics engines\n\n" + MachineText() + ".\n";
  if (!notes.empty()) text += "\n" + notes;
  const auto section = [&](const char* title, const char* table, const char* corner,
                           const char* reading) {
    const std::string body = MarkdownOf(measurements, table, corner);
    if (body.empty()) return;
    text += fmt::format("\n## {}\n\n{}\n\n{}", title, reading, body);
  };
  section(
      "Engines", "rate", "engine",
      "Hands that hold a 55 mm cube while their targets move at random; objects that fall are "
      "put back. Control steps of one environment per second on one thread, counting the time "
      "in `BatchSim::Step` alone: median [lowest, highest] of time slices that the engines "
      "take in turn. A label is engine and substeps; for lanes substeps x inner steps x "
      "iterations. Processor time leaves out what other programs took meanwhile; the tables below "
      "use it wherever one thread works.");
  section("Ratios", "ratio", "engines", "Slice by slice: median [lowest, highest].");
  section("Settings of lanes", "lanes", "setting", "One thread, one object.");
  section("Phases of lanes", "phases", "setting", "Share of the kernels' time on one thread.");
  section(
      "Number of environments", "environments", "engine",
      "1000 env-steps/s in all, one object: one worker by processor time, several by the clock.");
  section("Number of different objects", "objects", "engine",
          "1000 env-steps/s on one thread: a cube; random compounds of convex parts, environments "
          "next to each other holding different ones; the same in the largest number of "
          "environments, and its ratio to the cube; the harmonic mean over runs with one compound "
          "each, and the ratio to it, which leaves out what the compounds cost by themselves.");
  section("Memory", "memory", "engine", "What one more environment takes on the heap.");
  return text;
}

}  // namespace dexremoe
