#include "base/bytes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/check.h"
#include "base/log.h"

namespace dexremoe {
namespace {

std::vector<std::uint8_t> Image() {
  ByteWriter writer;
  writer.Put(3);
  writer.Put(0.1);
  writer.PutVector(std::vector<float>{1, 2, 3});
  writer.PutVector(std::vector<double>{});
  return writer.Take();
}

TEST(Bytes, ValuesComeBackBitForBit) {
  const auto bytes = Image();
  ByteReader reader(bytes);
  EXPECT_EQ(reader.Get<int>(), 3);
  EXPECT_EQ(reader.Get<double>(), 0.1);
  EXPECT_EQ(reader.GetVector<float>(), (std::vector<float>{1, 2, 3}));
  EXPECT_TRUE(reader.GetVector<double>().empty());
  EXPECT_NO_THROW(reader.Finish());
}

TEST(Bytes, EveryTruncationIsNoticed) {
  const auto whole = Image();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::vector<std::uint8_t> bytes(whole.begin(), whole.begin() + size);
    ByteReader reader(bytes);
    EXPECT_THROW(
        {
          reader.Get<int>();
          reader.Get<double>();
          reader.GetVector<float>();
          reader.GetVector<double>();
        },
        Error)
        << size;
  }
}

TEST(Bytes, RestsAreNoticed) {
  auto bytes = Image();
  ByteReader reader(bytes);
  reader.Get<int>();
  EXPECT_THROW(reader.Finish(), Error);
}

TEST(Bytes, AnAbsurdLengthIsNotAllocated) {
  ByteWriter writer;
  writer.Put(~std::uint64_t{0});
  const auto bytes = writer.Take();
  ByteReader reader(bytes);
  EXPECT_THROW(reader.GetVector<double>(), Error);
}

TEST(CheckDeathTest, AFailedCheckPrintsBothValuesAndAborts) {
  const int a = 2, b = 5;
  EXPECT_DEATH(DEX_CHECK_EQ(a + 1, b), "a \\+ 1 == b: 3 against 5");
  EXPECT_DEATH(DEX_CHECK(a > b), "check failed: a > b");
  DEX_CHECK_LT(a, b);
}

TEST(Log, DurationsReadWell) {
  EXPECT_EQ(FormatDuration(4.24), "4.2 s");
  EXPECT_EQ(FormatDuration(59.96), "1 min 00 s");
  EXPECT_EQ(FormatDuration(200), "3 min 20 s");
  EXPECT_EQ(FormatDuration(3599.7), "1 h 00 min");
  EXPECT_EQ(FormatDuration(3723), "1 h 02 min");
  EXPECT_EQ(FormatDuration(NAN), "?");
}

TEST(Log, ProgressPrintsPlainLinesWhenThereIsNoTerminal) {
  ::testing::internal::CaptureStderr();
  {
    Progress progress("work", 10, 0);
    for (int i = 0; i <= 10; ++i) progress.Update(i, "note");
  }
  const std::string text = ::testing::internal::GetCapturedStderr();
  EXPECT_NE(text.find("work: 100 %"), std::string::npos) << text;
  EXPECT_EQ(text.find('\r'), std::string::npos);
}

}  // namespace
}  // namespace dexremoe
