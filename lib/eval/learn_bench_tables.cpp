// The tables of bench_learn.
#include <algorithm>

#include "base/error.h"
#include "base/log.h"
#include "eval/learn_bench.h"
#include "eval/learn_bench_limit.h"
#include "eval/learn_bench_peer.h"
#include "eval/sim_scenes.h"

namespace dexremoe {
namespace {

std::string RowName(const PpoOptions& ppo) {
  return fmt::format("{} x {}, {}", ppo.envs, ppo.mini_epochs, ppo.precision);
}

class LearnBench {
 public:
  LearnBench(const LearnBenchOptions& options, const HandModel& hand, const TaskOptions& task,
             int workers)
      : options_(options), hand_(hand), task_(task), pool_(workers) {}

  LearnBenchResult Run() {
    result_.notes = fmt::format("Workers: {}; hidden layers of {}; {} steps per iteration.\n",
                                pool_.workers(), options_.hidden, options_.horizon);
    if (options_.peer.empty()) result_.notes += "libtorch is left out: no --peer was given.\n";
    FindCube();
    for (const LearnBenchCase& each : options_.Cases()) Measure(each);
    DescribeLimits();
    return std::move(result_);
  }

 private:
  void FindCube() {
    GraspOptions grasp;
    grasp.count = 8;
    grasp.candidates = 256;
    grasp.hold_steps = 20;
    cube_.sim = BoxObject("cube", Eigen::Vector3d::Constant(0.055));
    cube_.grasps = GraspsOf(cube_.sim, grasp, task_, SettingOf(SimOptions(), "lanes", 2).sim, hand_,
                            options_.seed, pool_);
    if (cube_.grasps.empty()) Fail("cube: no grasp found by lanes");
  }

  // Training, the machine's peak and the peer take their slices in turn.
  void Measure(const LearnBenchCase& which) {
    const PpoOptions& ppo = which.ppo;
    LogInfo("{} environments, {} mini-epochs, {}", ppo.envs, ppo.mini_epochs, ppo.precision);
    const PolicyOptions policy = options_.Policy();
    ResetPeakMemory();
    TimedTraining training(ppo, policy, hand_, task_, cube_, options_.seed, pool_);
    // What the first iteration costs more is lost in a long one.
    constexpr double kLong = 1 << 17;  // rows
    if (training.samples() * ppo.mini_epochs < kLong) training.WarmUp();
    double memory = 0;
    SliceTimes peak;
    std::vector<PeerUpdate> peers;
    for (int slice = 0; slice < which.slices; ++slice) {
      training.RunSlice(options_.slice);
      if (slice == 0) memory = PeakMemory();
      peak.Add(ProductCost(pool_, ppo.precision, options_.slice), 1);
      if (which.compare)
        peers.push_back(RunPeer(options_.peer, ppo, policy, pool_.workers(), options_.slice));
    }
    if (which.paper) return RecordPapers(ppo, training, memory);
    RecordTraining(RowName(ppo), training, memory);
    RecordOperations(ppo, training, peak);
    if (!peers.empty()) RecordPeer(ppo, training, peers);
  }

  void Record(const std::string& table, const std::string& row, const std::string& column,
              const std::vector<double>& values, double unit, int decimals) {
    const Spread s = SpreadOf(values);
    result_.measurements.push_back(
        {table, row, column, s.median / unit, decimals,
         fmt::format("[{:.{}f}, {:.{}f}]", s.low / unit, decimals, s.high / unit, decimals)});
  }
  void Record(const std::string& table, const std::string& row, const std::string& column,
              double value, int decimals) {
    result_.measurements.push_back({table, row, column, value, decimals, ""});
  }

  // Of one thread by processor time, of several by the clock.
  const std::vector<double>& Seconds(const SliceTimes& times) const {
    return pool_.workers() == 1 ? times.cpu : times.wall;
  }

  void RecordTraining(const std::string& row, const TimedTraining& training, double memory) {
    const double samples = training.samples();
    const auto rate = [&](const char* column, const SliceTimes& times, double work) {
      Record("rate", row, column, RatesOf(work, Seconds(times)), 1e3, 1);
    };
    rate("inference", training.forward(), samples / options_.horizon);
    rate("update", training.update(), samples);
    rate("end to end", training.iteration(), samples);
    Record("rate", row, "s per iteration", training.iteration().wall, 1, 2);
    Record("rate", row, "peak memory, GiB", memory, 3);
  }

  void RecordOperations(const PpoOptions& ppo, const TimedTraining& training,
                        const SliceTimes& peak_times) {
    const std::string row = RowName(ppo);
    const double forward = ForwardOperations(training.layout()), samples = training.samples();
    const double sample = OperationsPerSample(forward, ppo);
    const std::vector<double> peak = RatesOf(1, Seconds(peak_times));
    const auto rates = [&](const char* part, const SliceTimes& times, double operations) {
      const std::vector<double> rate = RatesOf(operations, Seconds(times));
      Record("operations", row, part, rate, 1e9, 1);
      std::vector<double> share;
      for (std::size_t i = 0; i < rate.size(); ++i) share.push_back(rate[i] / peak[i]);
      Record("operations", row, std::string(part) + ", % of peak", share, 0.01, 0);
    };
    Record("operations", row, "peak", peak, 1e9, 1);
    rates("inference", training.forward(), forward * ppo.envs);
    rates("update", training.update(), 3 * forward * ppo.mini_epochs * samples);
    rates("end to end", training.iteration(), sample * samples);
    const double rate = SpreadOf(RatesOf(samples, Seconds(training.iteration()))).median;
    limits_.push_back({ppo, pool_.workers(), sample, SpreadOf(peak).median, rate});
  }

  // Of the fastest size with the main number of mini-epochs, in each precision.
  void DescribeLimits() {
    const LearnLimit* last = nullptr;
    for (const std::string& precision : options_.precision) {
      const LearnLimit* best = nullptr;
      for (const LearnLimit& each : limits_)
        if (each.ppo.precision == precision && each.ppo.mini_epochs == options_.mini_epochs &&
            (best == nullptr || each.rate > best->rate))
          best = &each;
      if (best == nullptr) continue;
      result_.limits += LimitText(*best) + "\n";
      last = best;
    }
    std::vector<double> peaks = options_.assumed_peaks;
    for (double& peak : peaks) peak *= 1e9;
    if (last != nullptr && !peaks.empty()) result_.limits += OtherCoreText(*last, peaks);
  }

  void RecordPeer(const PpoOptions& ppo, const TimedTraining& training,
                  const std::vector<PeerUpdate>& peers) {
    const std::string row = RowName(ppo);
    const double parameters = static_cast<double>(training.layout().size());
    SliceTimes times;
    double memory = 0;
    for (const PeerUpdate& peer : peers) {
      if (peer.parameters != parameters)
        Fail("{}: parameters: expected {}, found {}", options_.peer, parameters, peer.parameters);
      times.Add({peer.wall, peer.cpu}, 1);
      memory = std::max(memory, peer.peak_memory);
    }
    const SliceTimes& ours = training.update();
    Record("peer", row, "ours", RatesOf(training.samples(), Seconds(ours)), 1e3, 1);
    Record("peer", row, "libtorch", RatesOf(training.samples(), Seconds(times)), 1e3, 1);
    const auto ratio = [&](const char* column, const std::vector<double>& slow,
                           const std::vector<double>& fast) {
      std::vector<double> values;
      for (std::size_t i = 0; i < slow.size(); ++i) values.push_back(slow[i] / fast[i]);
      Record("peer", row, column, values, 1, 2);
    };
    ratio("ours / libtorch by the clock", times.wall, ours.wall);
    ratio("by processor time", times.cpu, ours.cpu);
    Record("peer", row, "libtorch, GiB", memory, 3);
    const std::string note = fmt::format("libtorch {} with products of {}.\n",
                                         peers.front().version, peers.front().blas);
    if (result_.notes.find(note) == std::string::npos) result_.notes += note;
  }

  void RecordPapers(const PpoOptions& ppo, const TimedTraining& training, double memory) {
    const std::string& row = ppo.precision;
    Record("paper", row, "s", training.iteration().wall, 1, 1);
    Record("paper", row, "of them update, s", training.update().wall, 1, 1);
    Record("paper", row, "processor s", training.iteration().cpu, 1, 1);
    Record("paper", row, "peak memory, GiB", memory, 2);
  }

  LearnBenchOptions options_;
  const HandModel& hand_;
  const TaskOptions& task_;
  ThreadPool pool_;
  GraspedObject cube_;
  std::vector<LearnLimit> limits_;
  LearnBenchResult result_;
};

}  // namespace

LearnBenchResult RunLearnBench(const LearnBenchOptions& options, const HandModel& hand,
                               const TaskOptions& task, int workers) {
  return LearnBench(options, hand, task, workers).Run();
}

std::string LearnBenchResult::Markdown() const {
  std::string text = "# Speed of learning\n\n" + MachineText() + ".\n\n" + notes;
  const auto section = [&](const char* title, const char* table, const char* corner,
                           const char* reading) {
    const std::string body = MarkdownOf(measurements, table, corner);
    if (!body.empty()) text += fmt::format("\n## {}\n\n{}\n\n{}", title, reading, body);
  };
  const char* const size = "environments x mini-epochs";
  section("Rates", "rate", size,
          "The base policy on lanes with a 55 mm cube in every hand, networks in float32 (f32) or "
          "bfloat16 (bf16), 1000 samples/s: forward passes of all environments alone; the PPO "
          "update alone, of a whole batch; rollouts with physics and updates, end to end. Median "
          "[lowest, highest] of time slices; one worker by processor time, several by the clock. A "
          "minibatch is 16384 rows or, where smaller, the batch, unless chosen otherwise. Peak "
          "memory is the whole process.");
  section("Operations", "operations", size,
          "GFLOP/s, with time as above. A forward pass counts two operations per weight and row, "
          "an update three times as many per row and mini-epoch; the peak is products of "
          "1024 x 1024 matrices in the row's precision (oneDNN), one at a time on every thread, in "
          "the same turns.");
  if (!limits.empty()) text += "\n" + limits;
  section("Against libtorch", "peer", size,
          "The same update in the same precision (libtorch's bf16 is its autocast), 1000 "
          "samples/s: network, minibatch, loss, gradient clipping, Adam and adaptive rate are the "
          "same, and threads as many. Ratios slice by slice: median [lowest, highest]; above one "
          "this program is faster. libtorch's threads wait by spinning, which counts as processor "
          "time and costs it most where other programs run; on a busy machine one worker compares "
          "best.");
  section("The paper's iteration", "paper", "precision",
          "32768 environments x 8 steps, minibatch 16384, 5 mini-epochs, once: rollout and update "
          "by the clock, and processor time of all threads.");
  return text;
}

}  // namespace dexremoe
