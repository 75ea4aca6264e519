#include "base/thread_pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <stdexcept>
#include <thread>

namespace dexremoe {
namespace {

TEST(ThreadPool, EveryChunkRunsExactlyOnce) {
  for (const int workers : {1, 2, 4, 7}) {
    ThreadPool pool(workers);
    EXPECT_EQ(pool.workers(), workers);
    for (const int chunks : {0, 1, 3, 100}) {
      std::vector<std::atomic<int>> count(chunks);
      pool.ParallelFor(chunks, [&](int chunk, int worker) {
        EXPECT_GE(worker, 0);
        EXPECT_LT(worker, workers);
        ++count[chunk];
      });
      for (const auto& c : count) EXPECT_EQ(c.load(), 1);
    }
  }
}

TEST(ThreadPool, ManyShortJobsNeitherLoseNorRepeatWork) {
  ThreadPool pool(4);
  std::atomic<long> sum{0};
  for (int job = 0; job < 5000; ++job)
    pool.ParallelFor(5, [&](int chunk, int) { sum += chunk + 1; });
  EXPECT_EQ(sum.load(), 5000L * 15);
}

TEST(ThreadPool, TheCallerSeesAllWritesOfTheWorkers) {
  ThreadPool pool(3);
  for (int job = 0; job < 200; ++job) {
    std::vector<int> values(64, 0);
    pool.ParallelFor(64, [&](int chunk, int) { values[chunk] = chunk + job; });
    EXPECT_EQ(std::accumulate(values.begin(), values.end(), 0), 63 * 32 + 64 * job);
  }
}

TEST(ThreadPool, WorkersRunAtTheSameTime) {
  ThreadPool pool(3);
  std::atomic<int> inside{0};
  // Each chunk waits for the two others: with fewer than three threads this would never end.
  pool.ParallelFor(3, [&](int, int) {
    ++inside;
    while (inside.load() < 3) std::this_thread::yield();
  });
  EXPECT_EQ(inside.load(), 3);
}

TEST(ThreadPool, AnExceptionReachesTheCallerAndThePoolLivesOn) {
  ThreadPool pool(3);
  for (int job = 0; job < 20; ++job) {
    EXPECT_THROW(pool.ParallelFor(50,
                                  [](int chunk, int) {
                                    if (chunk == 7) throw std::runtime_error("seven");
                                  }),
                 std::runtime_error);
    std::atomic<int> count{0};
    pool.ParallelFor(50, [&](int, int) { ++count; });
    EXPECT_EQ(count.load(), 50);
  }
}

TEST(ThreadPool, ZeroWorkersMeansAllProcessors) {
  EXPECT_EQ(ThreadPool(0).workers(),
            std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
}

}  // namespace
}  // namespace dexremoe
