#include "render/video.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "base/error.h"
#include "io/atomic_file.h"

namespace dexremoe {
namespace {

class Video : public testing::Test {
 protected:
  std::string path_ = testing::TempDir() + "/dexremoe_video_test.mp4";
  void SetUp() override { TearDown(); }
  void TearDown() override {
    std::filesystem::remove(path_);
    std::filesystem::remove(path_ + ".tmp");
  }
  void Write(int frames) {
    VideoWriter video(path_, 64, 48, 30);
    for (int f = 0; f < frames; ++f) video.Add(Image(64, 48, std::uint8_t(8 * f), 128, 40));
    video.Finish();
  }
  // What ffprobe says about the stream.
  std::string Probe() const {
    const std::string out = path_ + ".txt";
    const std::string command =
        "ffprobe -v error -count_frames -select_streams v -show_entries "
        "stream=codec_name,width,height,pix_fmt,r_frame_rate,nb_read_frames -of csv=p=0 '" +
        path_ + "' > '" + out + "'";
    EXPECT_EQ(std::system(command.c_str()), 0);
    const std::string text = ReadFile(out);
    std::filesystem::remove(out);
    return text;
  }
};

TEST_F(Video, HoldsEveryFrameAsH264) {
  Write(13);
  EXPECT_EQ(Probe(), "h264,64,48,yuv420p,30/1,13\n");
}

TEST_F(Video, EqualFramesGiveEqualBytes) {
  Write(10);
  const std::string first = ReadFile(path_);
  Write(10);
  EXPECT_EQ(ReadFile(path_), first);
}

TEST_F(Video, OddSizesAreRefused) {
  EXPECT_THROW(VideoWriter(path_, 63, 48, 30), Error);
  EXPECT_THROW(VideoWriter(path_, 64, 47, 30), Error);
}

TEST_F(Video, AnUnfinishedFilmLeavesNothing) {
  {
    VideoWriter video(path_, 64, 48, 30);
    video.Add(Image(64, 48, 1, 2, 3));
  }
  EXPECT_FALSE(std::filesystem::exists(path_));
  EXPECT_FALSE(std::filesystem::exists(path_ + ".tmp"));
}

TEST_F(Video, WithoutFfmpegTheErrorSaysSo) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  std::string message;
  try {
    Write(1);
  } catch (const Error& error) {
    message = error.what();
  }
  setenv("PATH", path.c_str(), 1);
  EXPECT_NE(message.find("ffmpeg"), std::string::npos) << message;
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(Video, WhenFfmpegFailsTheErrorRepeatsItsWords) {
  // An ffmpeg that takes no frames: a folder stands where it must write.
  std::filesystem::create_directories(path_ + ".tmp");
  try {
    Write(40);
    ADD_FAILURE() << "a folder was overwritten";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("ffmpeg failed: "), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("directory"), std::string::npos) << error.what();
  }
  EXPECT_FALSE(std::filesystem::exists(path_));
}

}  // namespace
}  // namespace dexremoe
