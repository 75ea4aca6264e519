#include "base/confined.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <vector>

#include "base/error.h"
#include "base/thread_pool.h"

namespace dexremoe {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(RunConfined, HandsBackWhatTheWorkReturns) {
  const std::string large(10000000, 'x');
  EXPECT_EQ(RunConfined("work", {}, [&] { return large; }), large);
  EXPECT_EQ(RunConfined("work", {}, [] { return std::string(); }), "");
}

TEST(RunConfined, ChangesNothingHere) {
  int value = 1;
  RunConfined("work", {}, [&] {
    value = 2;
    return std::string();
  });
  EXPECT_EQ(value, 1);
}

TEST(RunConfined, HoldsNothingOpenThatTheCallerHolds) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const auto is_pipe = [](int descriptor) {
    struct stat facts;
    return fstat(descriptor, &facts) == 0 && S_ISFIFO(facts.st_mode);
  };
  ASSERT_TRUE(is_pipe(ends[0]) && is_pipe(ends[1]));
  const std::string pipes =
      RunConfined("work", {}, [&] { return std::to_string(is_pipe(ends[0]) + is_pipe(ends[1])); });
  EXPECT_EQ(pipes, "0");
  for (const int end : ends) close(end);
}

TEST(RunConfined, PassesErrorsOn) {
  EXPECT_THAT([] { RunConfined("work", {}, []() -> std::string { Fail("a.obj: bad"); }); },
              ThrowsMessage<Error>("a.obj: bad"));
}

TEST(RunConfined, TurnsACrashIntoAnError) {
  EXPECT_THAT(
      [] {
        RunConfined("work", {}, [] {
          std::raise(SIGSEGV);
          return std::string();
        });
      },
      ThrowsMessage<Error>(HasSubstr("work: crashed (signal 11")));
}

TEST(RunConfined, EndsWorkThatNeverEnds) {
  EXPECT_THAT(
      [] {
        RunConfined("work", {.seconds = 1}, [] {
          for (std::atomic<int> spin = 0; spin >= 0;) spin = 1 - spin;
          return std::string();
        });
      },
      ThrowsMessage<Error>(HasSubstr("work: took more than")));
}

TEST(RunConfined, EndsWorkThatWantsTooMuchMemory) {
  EXPECT_THAT(
      [] {
        RunConfined("work", {.memory = 0.1},
                    [] { return std::string(std::vector<char>(1 << 30, 'x').data(), 1); });
      },
      ThrowsMessage<Error>(HasSubstr("work: needs more than 0.1 GiB")));
}

TEST(RunConfined, RunsOnSeveralThreadsAtOnce) {
  ThreadPool pool(4);
  std::vector<std::string> results(24);
  pool.ParallelFor(24, [&](int i, int) {
    results[i] = RunConfined("work", {}, [i] { return std::to_string(i); });
  });
  for (int i = 0; i < 24; ++i) EXPECT_EQ(results[i], std::to_string(i));
}

}  // namespace
}  // namespace dexremoe
