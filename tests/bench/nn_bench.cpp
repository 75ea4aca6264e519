// Networks: what a core can do at most, and matrix products of the policy's shapes beside it.
#include <benchmark/benchmark.h>

#include <vector>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "nn/bf16_product.h"
#include "nn/kernels.h"
#include "nn/layers.h"
#include "nn/precision.h"

namespace dexremoe {
namespace {

void CountFlops(benchmark::State& bench, double flops) {
  bench.counters["FLOP/s"] = benchmark::Counter(flops * static_cast<double>(bench.iterations()),
                                                benchmark::Counter::kIsRate);
}

// y = x w^T for a block of rows; 2 n c k operations.
void LinearForwardBlock(benchmark::State& bench) {
  const std::int64_t n = 512, c = bench.range(0), k = bench.range(1);
  const std::vector<float> x(n * c, 0.5f), w(k * c, 0.25f), b(k, 0.1f);
  std::vector<float> y(n * k);
  for (auto _ : bench) {
    LinearForward(n, c, k, x.data(), w.data(), b.data(), y.data());
    benchmark::DoNotOptimize(y.data());
  }
  CountFlops(bench, 2.0 * static_cast<double>(n * c * k));
}
BENCHMARK(LinearForwardBlock)
    ->ArgNames({"in", "out"})
    ->Args({132, 512})
    ->Args({512, 512})
    ->Args({61, 256})
    ->UseRealTime();

#if defined(__x86_64__)
// Independent chains of fused multiply-adds in registers: the float32 limit of a core.
__attribute__((target("avx512f"))) void FusedMultiplyAdds(benchmark::State& bench) {
  if (!__builtin_cpu_supports("avx512f")) return bench.SkipWithError("no AVX-512");
  __m512 s0 = _mm512_set1_ps(1), s1 = s0, s2 = s0, s3 = s0, s4 = s0, s5 = s0, s6 = s0, s7 = s0;
  const __m512 factor = _mm512_set1_ps(0.999f), term = _mm512_set1_ps(1e-3f);
  for (auto _ : bench) {
    for (int i = 0; i < 1000; ++i) {
      s0 = _mm512_fmadd_ps(s0, factor, term), s1 = _mm512_fmadd_ps(s1, factor, term);
      s2 = _mm512_fmadd_ps(s2, factor, term), s3 = _mm512_fmadd_ps(s3, factor, term);
      s4 = _mm512_fmadd_ps(s4, factor, term), s5 = _mm512_fmadd_ps(s5, factor, term);
      s6 = _mm512_fmadd_ps(s6, factor, term), s7 = _mm512_fmadd_ps(s7, factor, term);
      asm volatile(""
                   : "+v"(s0), "+v"(s1), "+v"(s2), "+v"(s3), "+v"(s4), "+v"(s5), "+v"(s6),
                     "+v"(s7));
    }
  }
  CountFlops(bench, 1000.0 * 8 * 16 * 2);
}
BENCHMARK(FusedMultiplyAdds);
#endif

// y = x w^T of n rows in float32.
void Product(benchmark::State& bench) {
  const std::int64_t n = bench.range(0), c = bench.range(1), k = bench.range(2);
  const std::vector<float> x(n * c, 0.5f), w(k * c, 0.25f);
  std::vector<float> y(n * k);
  for (auto _ : bench) {
    Gemm<float>(false, true, n, k, c, 1, x.data(), c, w.data(), c, 0, y.data(), k);
    benchmark::DoNotOptimize(y.data());
  }
  CountFlops(bench, 2.0 * static_cast<double>(n * c * k));
}
BENCHMARK(Product)
    ->ArgNames({"rows", "in", "out"})
    ->Args({2048, 2048, 2048})
    ->Args({512, 512, 512});

// The same in bfloat16.
void Bfloat16Product(benchmark::State& bench) {
  if (!HasNativeBfloat16()) return bench.SkipWithError("no bfloat16 on this processor");
  const std::int64_t n = bench.range(0), c = bench.range(1), k = bench.range(2);
  const std::vector<BFloat16> x(n * c, {0x3f00}), w(k * c, {0x3e80});
  std::vector<BFloat16> y(n * k);
  Bf16Product product{n, k, c};
  product.transpose_b = true;
  product.lda = product.ldb = c;
  for (auto _ : bench) {
    RunProduct(product, x.data(), w.data(), nullptr, y.data());
    benchmark::DoNotOptimize(y.data());
  }
  CountFlops(bench, 2.0 * static_cast<double>(n * c * k));
}
BENCHMARK(Bfloat16Product)
    ->ArgNames({"rows", "in", "out"})
    ->Args({2048, 2048, 2048})
    ->Args({512, 512, 512})
    ->Args({512, 132, 512})
    ->Args({512, 61, 256});

void Elu(benchmark::State& bench) {
  std::vector<float> x(1 << 16, -0.5f), y(x.size());
  for (auto _ : bench) {
    EluArray(static_cast<std::int64_t>(x.size()), x.data(), y.data());
    benchmark::DoNotOptimize(y.data());
  }
  bench.counters["elements"] =
      benchmark::Counter(static_cast<double>(x.size()) * static_cast<double>(bench.iterations()),
                         benchmark::Counter::kIsRate);
}
BENCHMARK(Elu)->UseRealTime();

}  // namespace
}  // namespace dexremoe
