// Matrix products: against a naive loop, and from several threads at once.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <thread>
#include <tuple>
#include <vector>

#include "base/random.h"
#include "base/thread_pool.h"
#include "nn/layers.h"

namespace dexremoe {
namespace {

template <typename T>
std::vector<T> RandomValues(std::size_t count, std::uint64_t index) {
  Rng rng(7, Stream::kTest, {index});
  std::vector<T> values(count);
  for (T& value : values) value = static_cast<T>(rng.Uniform(-1, 1));
  return values;
}

// Worst |Gemm - naive sum in double|, relative to sqrt(k), over all of C, with padded rows.
template <typename T>
double WorstError(bool ta, bool tb, int m, int n, int k, T alpha, T beta) {
  const int lda = (ta ? m : k) + 3, ldb = (tb ? k : n) + 1, ldc = n + 2;
  const auto a = RandomValues<T>(static_cast<std::size_t>(lda) * (ta ? k : m), 1);
  const auto b = RandomValues<T>(static_cast<std::size_t>(ldb) * (tb ? n : k), 2);
  const auto before = RandomValues<T>(static_cast<std::size_t>(ldc) * m, 3);
  auto c = before;
  Gemm<T>(ta, tb, m, n, k, alpha, a.data(), lda, b.data(), ldb, beta, c.data(), ldc);
  double worst = 0;
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < ldc; ++j) {
      double expected = before[i * ldc + j];
      if (j < n) {
        double sum = 0;
        for (int l = 0; l < k; ++l)
          sum += static_cast<double>(ta ? a[l * lda + i] : a[i * lda + l]) *
                 (tb ? b[j * ldb + l] : b[l * ldb + j]);
        expected = alpha * sum + beta * expected;
      }
      worst = std::max(worst, std::abs(c[i * ldc + j] - expected) / std::sqrt(k));
    }
  return worst;
}

TEST(Gemm, MatchesANaiveLoopForAllTransposesAndOddSizes) {
  const std::vector<std::tuple<int, int, int>> sizes = {
      {1, 1, 1}, {3, 5, 7}, {17, 1, 33}, {1, 19, 2}, {64, 61, 38}, {129, 67, 253}, {256, 11, 512}};
  for (const auto& [m, n, k] : sizes)
    for (const bool ta : {false, true})
      for (const bool tb : {false, true})
        for (const double beta : {0.0, 1.0, 0.5}) {
          SCOPED_TRACE(::testing::Message() << m << "x" << n << "x" << k << " " << ta << tb);
          EXPECT_LT((WorstError<float>(ta, tb, m, n, k, 1.0f, static_cast<float>(beta))), 1e-6);
          EXPECT_LT((WorstError<double>(ta, tb, m, n, k, 0.75, beta)), 1e-14);
        }
}

TEST(Gemm, BetaZeroIgnoresWhatTheResultHeld) {
  const auto a = RandomValues<float>(6 * 4, 1), b = RandomValues<float>(4 * 5, 2);
  std::vector<float> c(30, NAN);
  Gemm<float>(false, false, 6, 5, 4, 1, a.data(), 4, b.data(), 5, 0, c.data(), 5);
  for (const float value : c) EXPECT_TRUE(std::isfinite(value));
}

// A layer's products in 16 row blocks, as the learner does them.
struct BlockedLayer {
  static constexpr int kBlocks = 16, kRows = 250, kInputs = 132, kOutputs = 512;
  std::vector<float> x = RandomValues<float>(kBlocks * kRows * kInputs, 4);
  std::vector<float> w = RandomValues<float>(kOutputs * kInputs, 5);
  std::vector<float> b = RandomValues<float>(kOutputs, 6);
  std::vector<float> y = std::vector<float>(kBlocks * kRows * kOutputs);
  std::vector<float> dx = std::vector<float>(kBlocks * kRows * kInputs);
  std::vector<float> dw = std::vector<float>(kBlocks * kOutputs * kInputs);
  std::vector<float> db = std::vector<float>(kBlocks * kOutputs);

  void Run(ThreadPool& pool) {
    std::fill(dw.begin(), dw.end(), 0.0f);
    std::fill(db.begin(), db.end(), 0.0f);
    pool.ParallelFor(kBlocks, [&](int block, int) {
      const float* rows = x.data() + block * kRows * kInputs;
      float* out = y.data() + block * kRows * kOutputs;
      LinearForward<float>(kRows, kInputs, kOutputs, rows, w.data(), b.data(), out);
      LinearBackward<float>(kRows, kInputs, kOutputs, rows, w.data(), out,
                            dx.data() + block * kRows * kInputs,
                            dw.data() + block * kOutputs * kInputs, db.data() + block * kOutputs);
    });
  }
};

bool SameBits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

TEST(Gemm, BitsDoNotDependOnTheNumberOfWorkers) {
  BlockedLayer reference;
  ThreadPool one(1);
  reference.Run(one);
  for (const int workers : {2, 4}) {
    ThreadPool pool(workers);
    for (int repetition = 0; repetition < 3; ++repetition) {
      BlockedLayer layer;  // new addresses each time: alignment must not matter either
      layer.Run(pool);
      EXPECT_TRUE(SameBits(reference.y, layer.y));
      EXPECT_TRUE(SameBits(reference.dx, layer.dx));
      EXPECT_TRUE(SameBits(reference.dw, layer.dw));
      EXPECT_TRUE(SameBits(reference.db, layer.db));
    }
  }
}

int ThreadsOfThisProcess() {
  const std::filesystem::directory_iterator tasks("/proc/self/task");
  return static_cast<int>(std::distance(begin(tasks), end(tasks)));
}

// oneDNN would split each product over an OpenMP team of its own, one per worker.
TEST(Gemm, StartsNoThreadsBesideTheWorkers) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one processor: no teams anyway";
  const int before = ThreadsOfThisProcess();
  BlockedLayer layer;
  ThreadPool pool(3);
  layer.Run(pool);
  EXPECT_EQ(ThreadsOfThisProcess(), before + 2);
}

}  // namespace
}  // namespace dexremoe
