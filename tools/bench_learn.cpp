// Times rollout inference, update and training, beside the machine's peak and libtorch.
#include <spdlog/fmt/fmt.h>

#include "base/options.h"
#include "eval/learn_bench.h"
#include "io/atomic_file.h"

namespace dexremoe {
namespace {

struct BenchLearnOptions {
  std::string out, csv;
  int workers = 0;
  bool quick = false;
  LearnBenchOptions bench;
  TaskOptions task;
  HandOptions hand;

  void Register(Options& options) {
    options.Add("out", &out, "Markdown file to write").NotStored();
    options.Add("csv", &csv, "the same numbers as CSV").NotStored();
    options.Add("workers", &workers, "threads; 0: one per processor").Range(0, 1024).NotStored();
    options.Add("quick", &quick, "small sizes that show that everything runs");
    bench.Register(options);
    task.Register(options);
    hand.Register(options);
  }
};

void Run(BenchLearnOptions& o) {
  o.task.Check();
  if (o.quick) o.bench.MakeQuick();
  const LearnBenchResult result = RunLearnBench(o.bench, LoadHand(o.hand), o.task, o.workers);
  const std::string text = result.Markdown();
  if (!o.out.empty()) WriteFile(o.out, text);
  if (!o.csv.empty()) WriteFile(o.csv, CsvOf(result.measurements));
  fmt::print("{}", text);
}

}  // namespace
}  // namespace dexremoe

int main(int argc, char** argv) {
  using namespace dexremoe;
  Options options("bench_learn", "Times the training of policies and its parts.",
                  "bench_learn --envs=2048,8192 --precision=f32 --out=results/bench/learn.md");
  BenchLearnOptions o;
  o.Register(options);
  return RunTool(options, argc, argv, [&] { Run(o); });
}
