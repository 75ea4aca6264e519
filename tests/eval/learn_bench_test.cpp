// The measurements behind bench_learn: what is counted, what is read from the peer, what is shown.
#include "eval/learn_bench.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "base/error.h"
#include "eval/learn_bench_limit.h"
#include "eval/learn_bench_peer.h"
#include "policy/policy.h"

namespace dexremoe {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

// A shell script in place of the libtorch program: it prints `line`, in which $7 is the argument
// for the precision, after a look at the others.
class FakePeer {
 public:
  explicit FakePeer(const std::string& line)
      : path_(fs::temp_directory_path() /
              ("dexremoe it's a peer " + std::to_string(getpid()) + ".sh")) {
    std::ofstream(path_) << "#!/bin/sh\n[ \"$OMP_NUM_THREADS $1\" = '2 --workers=2' ] || exit 3\n"
                         << "echo \"" << line << "\"\n";
    fs::permissions(path_, fs::perms::owner_all);
  }
  ~FakePeer() { fs::remove(path_); }
  std::string path() const { return path_; }

 private:
  fs::path path_;
};

TEST(LearnBench, OperationsAreTwoPerWeightThatARowMeets) {
  const auto policy = MakePolicy<float>(PolicyOptions().Base(66, 23, 11));
  const double encoder = 61 * 256 + 256 * 128 + 128 * 66;
  const double actor = 132 * 512 + 512 * 512 + 512 * (11 + 1);
  EXPECT_EQ(ForwardOperations(policy->layout()), 2 * (encoder + actor));
}

TEST(LearnBench, PeakMemoryFollowsWhatIsTouchedAndForgetsItWhenReset) {
  constexpr double kSize = 0.125;  // GiB
  ResetPeakMemory();
  const double before = PeakMemory();
  std::vector<char>(static_cast<std::size_t>(kSize * (1 << 30)), 'x');
  const double with = PeakMemory();
  EXPECT_GT(with, before + 0.9 * kSize);
  ResetPeakMemory();
  EXPECT_LT(PeakMemory(), with - 0.9 * kSize);
}

TEST(LearnBench, AStopwatchSeesTheWorkOfEveryThread) {
  const auto work = [] {
    volatile double sum = 0;
    for (int i = 0; i < 10'000'000; ++i) sum = sum + i;
  };
  const Stopwatch alone;
  work();
  const Cost one = alone.Read();
  const Stopwatch together;
  std::thread other(work);
  work();
  other.join();
  EXPECT_GT(together.Read().cpu, 1.5 * one.cpu);
}

TEST(LearnBench, ALineOfThePeerIsReadFieldByField) {
  const PeerUpdate peer = ParsePeer("peer", "1.13.1,openblas/libblas.so.3,399545,2,0.5,0.75,1.5\n");
  EXPECT_EQ(peer.version, "1.13.1");
  EXPECT_EQ(peer.blas, "openblas/libblas.so.3");
  EXPECT_EQ(peer.parameters, 399545);
  EXPECT_EQ(peer.wall, 0.5);
  EXPECT_EQ(peer.cpu, 0.75);
  EXPECT_EQ(peer.peak_memory, 1.5);
}

TEST(LearnBench, AWrongLineOfThePeerIsNamed) {
  EXPECT_THAT([] { ParsePeer("peer", "1.13.1,blas,5"); },
              ThrowsMessage<Error>(HasSubstr("peer: output: expected a line of 7 fields")));
  EXPECT_THAT([] { ParsePeer("peer", "1.13.1,blas,5,1,0.5s,1,1"); },
              ThrowsMessage<Error>(HasSubstr("field 5: expected a positive number, found '0.5s'")));
}

TEST(LearnBench, APeerThatFailsIsNamed) {
  EXPECT_THAT([] { RunPeer("/nowhere/peer", PpoOptions(), PolicyOptions(), 1, 0.1); },
              ThrowsMessage<Error>(HasSubstr("/nowhere/peer: expected success")));
}

TEST(LearnBench, APeerWithAnotherNetworkIsRefused) {
  const FakePeer peer("9.9,blas,17,1,0.5,0.5,0.1");
  LearnBenchOptions options;
  options.MakeQuick();
  options.peer = peer.path();
  EXPECT_THAT([&] { RunLearnBench(options, LoadHand({}), TaskOptions(), 2); },
              ThrowsMessage<Error>(HasSubstr("parameters: expected")));
}

TEST(LearnBench, AMinibatchIsNeverLargerThanTheBatch) {
  const LearnBenchOptions options;
  for (const int envs : {1, 512, 2048, 32768}) {
    const PpoOptions ppo = options.Ppo(envs, 1, "f32");
    EXPECT_NO_THROW(ppo.Check());
    EXPECT_EQ(ppo.minibatch, std::min(16384, 8 * envs));
  }
}

TEST(LearnBench, CasesAreAllSizesInEveryPrecisionAndThePapersIterationOnce) {
  LearnBenchOptions options;
  options.precision = {"f32", "bf16"};
  options.envs = {512, 2048};
  options.more_epochs = {1};
  options.peer = "peer";
  std::vector<std::string> found;
  for (const LearnBenchCase& each : options.Cases())
    found.push_back(fmt::format("{} x {}, {}{}{}", each.ppo.envs, each.ppo.mini_epochs,
                                each.ppo.precision, each.compare ? ", peer" : "",
                                each.paper ? ", paper" : ""));
  EXPECT_THAT(found, testing::ElementsAre("512 x 3, f32, peer", "2048 x 3, f32, peer",
                                          "2048 x 1, f32", "32768 x 5, f32, paper",
                                          "512 x 3, bf16, peer", "2048 x 3, bf16, peer",
                                          "2048 x 1, bf16", "32768 x 5, bf16, paper"));
}

TEST(LearnBench, ASampleCostsItsStepItsShareOfTheLastPassAndThreePassesPerMiniEpoch) {
  PpoOptions ppo;
  ppo.horizon = 4;
  ppo.mini_epochs = 2;
  EXPECT_EQ(OperationsPerSample(100, ppo), 100 + 25 + 600);
}

// Two cores: 2 of every 4 s are products; the rest stays, or vanishes, on a core with twice a
// core's peak.
TEST(LearnBench, AFasterCoreShortensProductsAlone) {
  LearnLimit limit;
  limit.workers = 2;
  limit.operations = 10;
  limit.peak = 20;
  limit.rate = 1;
  EXPECT_DOUBLE_EQ(limit.AtPeak(), 2);
  EXPECT_DOUBLE_EQ(limit.OfCore(10), 0.5);
  EXPECT_DOUBLE_EQ(limit.OfCore(20), 1 / 1.5);
  EXPECT_DOUBLE_EQ(limit.OfCoreAtMost(20), 2);
  EXPECT_THAT(LimitText(limit), HasSubstr(", 50 %"));
}

TEST(LearnBench, EveryTableHasItsNumbers) {
  LearnBenchOptions options;
  options.MakeQuick();
  options.envs = {64};
  const auto policy = MakePolicy<float>(options.Policy().Base(66, 23, 11));
  const FakePeer peer(fmt::format("9.9 $7,blas,{},1,1000,1000,0.1", policy->layout().size()));
  options.peer = peer.path();
  const LearnBenchResult result = RunLearnBench(options, LoadHand({}), TaskOptions(), 2);
  for (const char* table : {"rate", "operations", "peer"})
    EXPECT_NE(MarkdownOf(result.measurements, table, ""), "") << table;
  double update = 0;
  for (const Measurement& m : result.measurements) {
    EXPECT_GT(m.value, 0) << m.table << ", " << m.row << ", " << m.column;
    if (m.table != "rate") continue;
    if (m.column == "update") update = m.value;
    if (m.column == "end to end") {
      EXPECT_LT(m.value, update) << m.row;
    }
  }
  const std::string text = result.Markdown();
  for (const std::string& precision : NativePrecisions()) {
    // The peer computes in the same precision, at the main number of mini-epochs alone.
    EXPECT_THAT(text, HasSubstr("libtorch 9.9 --precision=" + precision));
    EXPECT_THAT(MarkdownOf(result.measurements, "peer", ""),
                AllOf(HasSubstr("| 64 x 2, " + precision), Not(HasSubstr("| 64 x 1, "))));
    EXPECT_THAT(text, HasSubstr("In " + precision + ", 64 environments x 2 mini-epochs take"));
  }
  EXPECT_THAT(text, HasSubstr("Arithmetic, not measurement"));
  EXPECT_THAT(text, Not(HasSubstr("The paper's iteration")));
}

}  // namespace
}  // namespace dexremoe
