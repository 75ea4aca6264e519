#include "io/event_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>

#include "base/error.h"
#include "event_reader.h"

namespace dexremoe {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;

class EventFileTest : public ::testing::Test {
 protected:
  EventFileTest()
      : folder_(fs::path(::testing::TempDir()) / ("dex_events_" + std::to_string(getpid()))) {
    fs::remove_all(folder_);
  }
  ~EventFileTest() override { fs::remove_all(folder_); }

  // Steps of the events that carry scalars.
  std::vector<std::int64_t> Steps() const {
    std::vector<std::int64_t> steps;
    for (const ReadEvent& event : EventReader::ReadFolder(folder_))
      if (!event.scalars.empty()) steps.push_back(event.step);
    return steps;
  }
  // Adds an event at each step.
  void Write(std::int64_t after, const std::vector<std::int64_t>& steps) const {
    EventFile file(folder_, after);
    for (const std::int64_t step : steps) file.Add(step, 0, {{"x", static_cast<double>(step)}});
  }
  fs::path Newest() const {
    fs::path newest;
    for (const auto& entry : fs::directory_iterator(folder_))
      newest = std::max(newest, entry.path());
    return newest;
  }

  fs::path folder_;
};

TEST(EventFile, ChecksumAgreesWithThePublishedExamples) {
  EXPECT_EQ(Crc32c("123456789"), 0xE3069283u);
  EXPECT_EQ(Crc32c(std::string(32, '\0')), 0x8A9136AAu);  // RFC 3720, B.4
  EXPECT_EQ(Crc32c(std::string(32, '\xFF')), 0x62A8AB43u);
}

TEST_F(EventFileTest, AnIndependentReaderGetsBackWhatWasWritten) {
  {
    EventFile file(folder_, 0);
    file.Add(300, 1.5e9, {{"loss/policy", -0.25}, {"fps/total", 98765}});
    file.Add(std::int64_t{1} << 40, 1.5e9 + 1, {{"loss/policy", 2}, {"kl", NAN}});
  }
  const std::vector<ReadEvent> events = EventReader::ReadFolder(folder_);
  ASSERT_EQ(events.size(), 3u);
  EXPECT_EQ(events[0].file_version, "brain.Event:2");
  EXPECT_EQ(events[1].step, 300);
  EXPECT_EQ(events[1].wall_time, 1.5e9);
  EXPECT_EQ(events[1].scalars,
            (std::map<std::string, float>{{"loss/policy", -0.25f}, {"fps/total", 98765.0f}}));
  EXPECT_EQ(events[2].step, std::int64_t{1} << 40);
  EXPECT_EQ(events[2].scalars, (std::map<std::string, float>{{"loss/policy", 2.0f}}));
}

TEST_F(EventFileTest, EventsAreOnDiskWhileTheFileIsOpen) {
  EventFile file(folder_, 0);
  file.Add(5, 0, {{"x", 1}});
  EXPECT_THAT(Steps(), ElementsAre(5));
}

TEST_F(EventFileTest, ContinuingCutsEventsBeyondTheStep) {
  Write(0, {100, 200, 300});
  Write(200, {300, 400});
  EXPECT_THAT(Steps(), ElementsAre(100, 200, 300, 400));
  Write(100, {200});
  EXPECT_THAT(Steps(), ElementsAre(100, 200));
  Write(0, {50});
  EXPECT_THAT(Steps(), ElementsAre(50));
}

TEST_F(EventFileTest, ContinuingDropsARecordThatAKillLeftTorn) {
  Write(0, {100, 200});
  fs::resize_file(Newest(), fs::file_size(Newest()) - 3);
  EXPECT_THROW(Steps(), std::runtime_error);
  Write(200, {300});
  EXPECT_THAT(Steps(), ElementsAre(100, 300));
}

TEST_F(EventFileTest, FilesOfOtherProgramsAreLeftAlone) {
  Write(0, {100});
  std::ofstream(folder_ / "events.out.tfevents.99999.host") << "foreign";
  Write(0, {100});
  EXPECT_EQ(fs::file_size(folder_ / "events.out.tfevents.99999.host"), 7u);
}

TEST_F(EventFileTest, AFolderThatCannotBeMadeIsNamed) {
  std::ofstream(folder_) << "a file";
  try {
    EventFile file(folder_, 0);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr(folder_.string()));
  }
}

}  // namespace
}  // namespace dexremoe
