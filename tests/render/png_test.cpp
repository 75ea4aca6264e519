#include "io/png.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "base/error.h"
#include "base/random.h"
#include "io/atomic_file.h"

namespace dexremoe {
namespace {

class Png : public testing::Test {
 protected:
  std::string path_ = testing::TempDir() + "/dexremoe_png_test.png";
  void TearDown() override { std::filesystem::remove(path_); }

  static Image Noise(int width, int height) {
    Image image(width, height, 0, 0, 0);
    Rng rng(7, Stream::kTest);
    for (std::uint8_t& byte : image.rgb) byte = std::uint8_t(rng.Index(256));
    return image;
  }
};

TEST_F(Png, ComesBackPixelForPixel) {
  const Image image = Noise(37, 23);
  WritePng(path_, image);
  const Image back = ReadPng(path_);
  EXPECT_EQ(back.width, 37);
  EXPECT_EQ(back.height, 23);
  EXPECT_EQ(back.rgb, image.rgb);
}

TEST_F(Png, EqualImagesGiveEqualBytes) {
  WritePng(path_, Noise(50, 40));
  const std::string first = ReadFile(path_);
  WritePng(path_, Noise(50, 40));
  EXPECT_EQ(ReadFile(path_), first);
}

TEST_F(Png, TruncatedOrForeignFilesAreRefusedByName) {
  WritePng(path_, Noise(50, 40));
  const std::string whole = ReadFile(path_);
  for (const std::string& bytes :
       {whole.substr(0, whole.size() / 2), std::string("not a picture")}) {
    WriteFile(path_, bytes);
    try {
      ReadPng(path_);
      FAIL() << "a broken file was read";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(path_), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(ReadPng(path_ + ".missing"), Error);
}

TEST_F(Png, AnImageWithoutPixelsIsRefusedAndLeavesTheOldFile) {
  WriteFile(path_, "old");
  EXPECT_THROW(WritePng(path_, Image()), Error);
  EXPECT_EQ(ReadFile(path_), "old");
}

}  // namespace
}  // namespace dexremoe
