// Networks: matrix products of the policy's shapes, in float32.
#include <benchmark/benchmark.h>

#include <vector>

#include "nn/kernels.h"
#include "nn/layers.h"

namespace dexremoe {
namespace {

// y = x w^T for a block of rows; 2 n c k operations.
void LinearForwardBlock(benchmark::State& bench) {
  const std::int64_t n = 512, c = bench.range(0), k = bench.range(1);
  const std::vector<float> x(n * c, 0.5f), w(k * c, 0.25f), b(k, 0.1f);
  std::vector<float> y(n * k);
  for (auto _ : bench) {
    LinearForward(n, c, k, x.data(), w.data(), b.data(), y.data());
    benchmark::DoNotOptimize(y.data());
  }
  bench.counters["FLOP/s"] = benchmark::Counter(
      2.0 * static_cast<double>(n * c * k * bench.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(LinearForwardBlock)
    ->ArgNames({"in", "out"})
    ->Args({132, 512})
    ->Args({512, 512})
    ->Args({61, 256})
    ->UseRealTime();

void Elu(benchmark::State& bench) {
  std::vector<float> x(1 << 16, -0.5f), y(x.size());
  for (auto _ : bench) {
    EluArray(static_cast<std::int64_t>(x.size()), x.data(), y.data());
    benchmark::DoNotOptimize(y.data());
  }
  bench.counters["elements"] = benchmark::Counter(
      static_cast<double>(x.size()) * static_cast<double>(bench.iterations()),
      benchmark::Counter::kIsRate);
}
BENCHMARK(Elu)->UseRealTime();

}  // namespace
}  // namespace dexremoe
