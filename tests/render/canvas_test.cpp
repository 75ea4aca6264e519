#include "render/canvas.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "render/font.h"
#include "test_meshes.h"

namespace dexremoe {
namespace {

// Sum of darkness over the image, in whole pixels of ink.
double Ink(const Image& image) {
  double sum = 0;
  for (const std::uint8_t byte : image.rgb) sum += (255 - byte) / 255.0 / 3;
  return sum;
}

TEST(Canvas, ABoxCoversItsAreaAtAnyOffset) {
  const Fonts fonts;
  for (const double offset : {0.0, 0.25, 0.5}) {
    Image image(60, 40, 255, 255, 255);
    Canvas(image, fonts).Box(10 + offset, 10 + offset, 20, 12, Color(0, 0, 0));
    EXPECT_NEAR(Ink(image), 240, 240 * 0.02) << offset;
  }
}

TEST(Canvas, RoundCornersTakeAwayTheirArea) {
  const Fonts fonts;
  Image image(60, 60, 255, 255, 255);
  Canvas(image, fonts).Box(10, 10, 40, 40, Color(0, 0, 0), 20);  // a disc
  EXPECT_NEAR(Ink(image), M_PI * 400, 15);
}

TEST(Canvas, OpacityMixes) {
  const Fonts fonts;
  Image image(8, 8, 200, 100, 0);
  Canvas(image, fonts).Box(0, 0, 8, 8, Color(1, 1, 1), 0, 0.5);
  EXPECT_NEAR(image.at(4, 4)[0], 227, 1);
  EXPECT_NEAR(image.at(4, 4)[1], 177, 1);
  EXPECT_NEAR(image.at(4, 4)[2], 127, 1);
}

TEST(Canvas, WhatLiesOutsideIsClipped) {
  const Fonts fonts;
  Image image(20, 20, 255, 255, 255);
  Canvas canvas(image, fonts);
  canvas.Box(-10, -10, 15, 15, Color(0, 0, 0));
  canvas.Text(15, 40, "far out", {});
  canvas.Paste(15, -5, Image(10, 10, 0, 0, 0));
  canvas.Paste(30, 30, Image(10, 10, 0, 0, 0));
  EXPECT_NEAR(Ink(image), 25 + 25, 0.01);
}

TEST(Canvas, TextIsInkedWithinItsWidthAndAligned) {
  const Fonts fonts;
  const TextStyle left{20, Color(0, 0, 0)};
  const double width = fonts.Width("Hand", left);
  EXPECT_NEAR(fonts.Width("Hand", {40}), 2 * width, 0.5);
  for (const Align align : {Align::kLeft, Align::kCenter, Align::kRight}) {
    Image image(200, 50, 255, 255, 255);
    TextStyle style = left;
    style.align = align;
    Canvas(image, fonts).Text(100, 35, "Hand", style);
    const double from = 100 - width * (align == Align::kLeft     ? 0
                                       : align == Align::kCenter ? 0.5
                                                                 : 1);
    int first = 200, last = -1;
    for (int x = 0; x < 200; ++x)
      for (int y = 0; y < 50; ++y)
        if (Lightness(image, x, y) < 128) {
          first = std::min(first, x);
          last = std::max(last, x);
        }
    EXPECT_NEAR(first, from, 4);
    EXPECT_NEAR(last, from + width, 4);
  }
}

TEST(Canvas, LongTextIsCutWithAnEllipsis) {
  const Fonts fonts;
  const TextStyle style{14};
  EXPECT_EQ(fonts.Fit("short", style, 500), "short");
  const std::string cut = fonts.Fit("a very long name of an object", style, 90);
  EXPECT_LE(fonts.Width(cut, style), 90);
  EXPECT_TRUE(cut.ends_with("…"));
  EXPECT_EQ(fonts.Fit("ääääää", style, fonts.Width("ää…", style) + 0.5), "ää…");
}

TEST(Utf8, WholeCharactersAreDecodedAndBrokenOnesMarked) {
  EXPECT_EQ(DecodeUtf8("aé…𝄞"), (std::u32string{U'a', U'é', U'…', U'\U0001D11E'}));
  EXPECT_EQ(DecodeUtf8("a\xff"
                       "b"),
            (std::u32string{U'a', U'\uFFFD', U'b'}));
  EXPECT_EQ(DecodeUtf8("\xe2\x80"), (std::u32string{U'\uFFFD', U'\uFFFD'}));
}

TEST(Fonts, AMissingFontIsNamed) {
  try {
    Font font("/no/such/font.ttf");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("/no/such/font.ttf"), std::string::npos);
  }
}

}  // namespace
}  // namespace dexremoe
