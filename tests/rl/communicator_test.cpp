#include "rl/communicator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "rl/rank_statistics.h"
#include "thread_communicator.h"

namespace dexremoe {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<float> RandomRows(int rank, std::size_t n) {
  Rng rng(1, Stream::kTest, {static_cast<std::uint64_t>(rank)});
  std::vector<float> rows(n);
  for (float& x : rows) x = static_cast<float>(rng.Normal() * std::pow(10, rng.Uniform(-4, 4)));
  return rows;
}

TEST(Communicator, SumsAreThoseInRankOrderBitForBitOnEveryRank) {
  for (const int ranks : {1, 2, 3, 5})
    for (const std::size_t n : {0, 1, 4, 1000}) {
      std::vector<float> expected = RandomRows(0, n);
      for (int r = 1; r < ranks; ++r) {
        const std::vector<float> more = RandomRows(r, n);
        for (std::size_t i = 0; i < n; ++i) expected[i] += more[i];
      }
      RunRanks(ranks, [&](Communicator& communicator) {
        std::vector<float> values = RandomRows(communicator.rank(), n);
        communicator.Sum(values);
        EXPECT_EQ(values, expected) << ranks << " ranks, " << n << " values";
      });
    }
}

TEST(Communicator, BroadcastGivesTheFirstRanksBytes) {
  RunRanks(3, [](Communicator& communicator) {
    std::vector<double> values = {1.0 + communicator.rank(), 2};
    communicator.Broadcast(std::as_writable_bytes(std::span(values)));
    EXPECT_THAT(values, ElementsAre(1, 2));
  });
}

TEST(Communicator, GatherKeepsRankOrderAndLengths) {
  RunRanks(3, [](Communicator& communicator) {
    const auto rank = static_cast<std::uint8_t>(communicator.rank());
    const std::vector<std::uint8_t> mine(rank, rank);
    const auto everywhere = communicator.AllGather(mine);
    EXPECT_THAT(everywhere, ElementsAre(IsEmpty(), ElementsAre(1), ElementsAre(2, 2)));
    const auto gathered = communicator.Gather(mine);
    if (rank == 0)
      EXPECT_EQ(gathered, everywhere);
    else
      EXPECT_THAT(gathered, IsEmpty());
  });
}

// Statistics of rows that are spread over ranks are those of all rows together.
class RankStatistics : public ::testing::TestWithParam<int> {
 protected:
  static constexpr int kRows = 30;
  static std::vector<float> AllRows(int ranks, int salt) {
    std::vector<float> all;
    for (int r = 0; r < ranks; ++r)
      for (const float x : RandomRows(100 * salt + r, kRows)) all.push_back(x);
    return all;
  }
  static std::vector<float> Share(const std::vector<float>& all, int rank) {
    return {all.begin() + rank * kRows, all.begin() + (rank + 1) * kRows};
  }
};

TEST_P(RankStatistics, MomentsAreThoseOfAllRows) {
  const std::vector<float> all = AllRows(GetParam(), 0);
  RunningMoments expected(3);
  UpdateMoments(7, all.data(), expected);  // something before
  const RunningMoments before = expected;
  UpdateMoments(static_cast<std::int64_t>(all.size() / 3), all.data(), expected);
  RunRanks(GetParam(), [&](Communicator& communicator) {
    RunningMoments mine = EmptyMoments(3), moments = before;
    UpdateMoments(kRows / 3, Share(all, communicator.rank()).data(), mine);
    MergeMoments(communicator, mine, moments);
    EXPECT_DOUBLE_EQ(moments.count, expected.count);
    for (int j = 0; j < 3; ++j) {
      EXPECT_NEAR(moments.mean[j], expected.mean[j], 1e-9 * std::sqrt(expected.variance[j]));
      EXPECT_NEAR(moments.variance[j], expected.variance[j], 1e-9 * expected.variance[j]);
    }
  });
}

TEST_P(RankStatistics, NormalisedAdvantagesAndExplainedVarianceAreThoseOfAllRows) {
  const std::vector<float> value = AllRows(GetParam(), 1), target = AllRows(GetParam(), 2);
  const double explained = ExplainedVariance(Alone(), value, target);
  std::vector<float> expected = target;
  NormalizeAdvantages(Alone(), expected);
  RunRanks(GetParam(), [&](Communicator& communicator) {
    const int rank = communicator.rank();
    EXPECT_NEAR(ExplainedVariance(communicator, Share(value, rank), Share(target, rank)), explained,
                1e-9);
    std::vector<float> mine = Share(target, rank);
    NormalizeAdvantages(communicator, mine);
    for (int i = 0; i < kRows; ++i) EXPECT_NEAR(mine[i], expected[rank * kRows + i], 1e-5);
  });
}

INSTANTIATE_TEST_SUITE_P(Ranks, RankStatistics, ::testing::Values(1, 2, 3));

TEST(Communicator, AProcessWithoutALauncherIsAlone) {
  const auto communicator = StartCommunicator();
  EXPECT_EQ(communicator->rank(), 0);
  EXPECT_EQ(communicator->size(), 1);
}

}  // namespace
}  // namespace dexremoe
