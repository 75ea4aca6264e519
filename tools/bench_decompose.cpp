// Measures convex decomposition over folders of meshes.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <iterator>

#include "base/options.h"
#include "eval/decompose_bench.h"
#include "io/atomic_file.h"

namespace dexremoe {
namespace {

struct BenchDecomposeOptions {
  std::vector<std::string> meshes = {"meshes/builtin"};
  std::string out, csv;
  int workers = 0;
  DecomposeBenchOptions bench;

  void Register(Options& options) {
    options.Add("meshes", &meshes, "folders with manifest.csv or CATEGORY/ folders");
    options.Add("out", &out, "Markdown file to write").NotStored();
    options.Add("csv", &csv, "one line per mesh").NotStored();
    options.Add("workers", &workers, "threads; 0: one per processor").Range(0, 1024).NotStored();
    bench.Register(options);
  }
};

void Run(const BenchDecomposeOptions& o) {
  ThreadPool pool(o.workers);
  std::vector<DecomposedMesh> results;
  for (const std::string& folder : o.meshes) {
    std::ranges::move(BenchFolder(folder, o.bench, pool), std::back_inserter(results));
    if (!o.bench.peer.empty())
      std::ranges::move(BenchPeerFolder(folder, o.bench, pool), std::back_inserter(results));
  }
  const std::string text = DecomposeMarkdown(results, o.bench);
  if (!o.out.empty()) WriteFile(o.out, text);
  if (!o.csv.empty()) WriteFile(o.csv, DecomposeCsv(results));
  fmt::print("{}", text);
}

}  // namespace
}  // namespace dexremoe

int main(int argc, char** argv) {
  using namespace dexremoe;
  Options options("bench_decompose", "Measures repair and convex decomposition of meshes.",
                  "bench_decompose --meshes=meshes/builtin --out=results/bench/decompose.md");
  BenchDecomposeOptions o;
  o.Register(options);
  return RunTool(options, argc, argv, [&] { Run(o); });
}
