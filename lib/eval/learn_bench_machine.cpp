#include "eval/learn_bench_machine.h"

#include <malloc.h>

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "nn/bf16_product.h"
#include "nn/layers.h"
#include "nn/precision.h"

namespace dexremoe {
namespace {

double SecondsOf(clockid_t clock) {
  timespec now;
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Cost Now() { return {SecondsOf(CLOCK_MONOTONIC), SecondsOf(CLOCK_PROCESS_CPUTIME_ID)}; }

constexpr std::int64_t kSize = 1024;  // of the matrices whose products show the peak

void Multiply(const float* a, const float* b, float* c) {
  Gemm(false, false, kSize, kSize, kSize, 1.0f, a, kSize, b, kSize, 0.0f, c, kSize);
}

void Multiply(const BFloat16* a, const BFloat16* b, BFloat16* c) {
  Bf16Product product{kSize, kSize, kSize};
  product.lda = product.ldb = kSize;
  RunProduct(product, a, b, nullptr, c);
}

// Of one operation, in matrices whose elements are all `value`.
template <typename T>
Cost CostOf(ThreadPool& pool, T value, double seconds) {
  constexpr int kProductsPerWorker = 4;  // short waits at the end of a round
  const std::vector<T> a(kSize * kSize, value), b(kSize * kSize, value);
  std::vector<std::vector<T>> c(pool.workers(), std::vector<T>(kSize * kSize));
  const int products = kProductsPerWorker * pool.workers();
  const Stopwatch stopwatch;
  double operations = 0;
  do {
    pool.ParallelFor(products,
                     [&](int, int worker) { Multiply(a.data(), b.data(), c[worker].data()); });
    operations += 2.0 * kSize * kSize * kSize * products;
  } while (stopwatch.Read().wall < seconds);
  const Cost spent = stopwatch.Read();
  return {spent.wall / operations, spent.cpu / operations};
}

}  // namespace

double ForwardOperations(const ParamLayout& layout) {
  double operations = 0;
  for (const ParamBlock& block : layout.blocks())
    if (block.name.ends_with("/weight") && !block.name.starts_with("encoder/cloud/"))
      operations += 2 * static_cast<double>(block.size());
  return operations;
}

void ResetPeakMemory() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";  // the high-water mark alone, see proc(5)
}

double PeakMemory() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::atof(line.c_str() + 6) / (1 << 20);  // kB
  Fail("/proc/self/status: expected a line VmHWM, found none");
}

Cost& Cost::operator+=(const Cost& other) {
  wall += other.wall;
  cpu += other.cpu;
  return *this;
}

Stopwatch::Stopwatch() : start_(Now()) {}

Cost Stopwatch::Read() const {
  const Cost now = Now();
  return {now.wall - start_.wall, now.cpu - start_.cpu};
}

Cost ProductCost(ThreadPool& pool, const std::string& precision, double seconds) {
  if (ResolvePrecision(precision) == "bf16") return CostOf<BFloat16>(pool, {0x3f00}, seconds);
  return CostOf<float>(pool, 0.5f, seconds);
}

}  // namespace dexremoe
