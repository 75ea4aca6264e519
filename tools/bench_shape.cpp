// Trains PointNet++ in each precision and tries it on objects that it never saw.
#include <cstdio>
#include <string>
#include <vector>

#include "base/options.h"
#include "eval/shape_bench.h"
#include "io/atomic_file.h"
#include "nn/precision.h"

namespace dexremoe {
namespace {

struct BenchShapeOptions {
  std::string objects, real, out, csv;
  int workers = 0;
  ShapeBenchOptions bench;
  CloudOptions cloud;

  void Register(Options& options) {
    options.Add("objects", &objects, "objects.csv: trained on its train split, tried on the others")
        .Required();
    options.Add("real", &real, "objects.csv of other meshes, all of which are tried; empty: none");
    options.Add("out", &out, "Markdown file to write").NotStored();
    options.Add("csv", &csv, "the same numbers as CSV").NotStored();
    options.Add("workers", &workers, "threads; 0: one per processor").Range(0, 1024).NotStored();
    bench.Register(options);
    cloud.Register(options);
  }
};

void Run(const BenchShapeOptions& o) {
  // Points that no cloud.h5 was sampled with.
  const std::uint64_t other_points = SeedOf(o.bench.seed, Stream::kTest);
  const LabelledClouds clouds = ReadLabelledClouds(o.objects);
  std::vector<ShapeSet> sets;
  if (!clouds.held_out.empty())
    sets.push_back(MakeShapeSet("out of distribution", clouds.held_out, o.cloud, other_points));
  if (!o.real.empty()) {
    LabelledClouds real = ReadLabelledClouds(o.real);
    real.train.insert(real.train.end(), real.held_out.begin(), real.held_out.end());
    sets.push_back(MakeShapeSet("real meshes", std::move(real.train), o.cloud, other_points));
  }
  ThreadPool pool(o.workers);
  std::string text;
  // Written after every precision: each takes minutes.
  RunShapeBench(o.bench, clouds, sets, NativePrecisions(), pool,
                [&](const ShapeBenchResult& result) {
                  text = result.Markdown();
                  if (!o.out.empty()) WriteFile(o.out, text);
                  if (!o.csv.empty()) WriteFile(o.csv, CsvOf(result.measurements));
                });
  std::fputs(text.c_str(), stdout);
}

}  // namespace
}  // namespace dexremoe

int main(int argc, char** argv) {
  using namespace dexremoe;
  Options options("bench_shape",
                  "Measures how well the shape network tells categories, in float32 and bfloat16, "
                  "and how its feature depends on sampling and pose.",
                  "bench_shape --objects=objects.csv --real=real.csv --out=results/bench/shape.md");
  BenchShapeOptions o;
  o.Register(options);
  return RunTool(options, argc, argv, [&] { Run(o); });
}
