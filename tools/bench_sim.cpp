// Times the physics engines side by side.
#include <spdlog/fmt/fmt.h>

#include "base/options.h"
#include "eval/sim_bench.h"
#include "io/atomic_file.h"

namespace dexremoe {
namespace {

struct BenchSimOptions {
  std::string out, csv;
  int workers = 0;
  bool quick = false;
  SimBenchOptions bench;
  TaskOptions task;
  HandOptions hand;

  void Register(Options& options) {
    options.Add("out", &out, "Markdown file to write").NotStored();
    options.Add("csv", &csv, "the same numbers as CSV").NotStored();
    options.Add("workers", &workers, "most threads; 0: one per processor")
        .Range(0, 1024)
        .NotStored();
    options.Add("quick", &quick, "small sizes that show that everything runs");
    bench.Register(options);
    task.Register(options);
    hand.Register(options);
  }
};

void Run(BenchSimOptions& o) {
  o.task.Check();
  if (o.quick) o.bench.MakeQuick();
  const SimBenchResult result = RunSimBench(o.bench, LoadHand(o.hand), o.task, o.workers);
  const std::string text = result.Markdown();
  if (!o.out.empty()) WriteFile(o.out, text);
  if (!o.csv.empty()) WriteFile(o.csv, CsvOf(result.measurements));
  fmt::print("{}", text);
}

}  // namespace
}  // namespace dexremoe

int main(int argc, char** argv) {
  using namespace dexremoe;
  Options options("bench_sim", "Times the physics engines on hands that hold objects.",
                  "bench_sim --out=results/bench/sim.md --csv=results/bench/sim.csv");
  BenchSimOptions o;
  o.Register(options);
  return RunTool(options, argc, argv, [&] { Run(o); });
}
