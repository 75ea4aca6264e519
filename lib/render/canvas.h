// Drawing over images: text, rounded boxes, bars, pictures in pictures.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <string_view>

#include "io/png.h"

namespace dexremoe {

// sRGB in [0, 1].
using Color = Eigen::Vector3f;

namespace ink {
inline const Color kText(0.13f, 0.15f, 0.18f);
inline const Color kFaint(0.43f, 0.46f, 0.50f);
inline const Color kLine(0.82f, 0.84f, 0.87f);
inline const Color kPaper(1, 1, 1);
inline const Color kGood(0.0f, 0.52f, 0.38f);
}  // namespace ink

enum class Align { kLeft, kCenter, kRight };

struct TextStyle {
  double size = 14;  // em, pixels
  Color color = ink::kText;
  Align align = Align::kLeft;
  bool bold = false;
};

// The two faces used everywhere (DejaVu Sans, regular and bold).
class Fonts {
 public:
  // Throws Error naming the font file that is missing.
  Fonts();
  ~Fonts();
  // Width in pixels.
  double Width(std::string_view text, const TextStyle& style) const;
  // The text itself, or its beginning and an ellipsis when it is wider than `width` pixels.
  std::string Fit(std::string_view text, const TextStyle& style, double width) const;

 private:
  friend class Canvas;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Draws into an image, pixel coordinates from the top left corner. What lies outside is clipped.
class Canvas {
 public:
  Canvas(Image& image, const Fonts& fonts) : image_(image), fonts_(fonts) {}

  int width() const { return image_.width; }
  int height() const { return image_.height; }
  const Fonts& fonts() const { return fonts_; }

  // (x, y): start, middle or end of the baseline.
  void Text(double x, double y, std::string_view text, const TextStyle& style);
  // With rounded corners and soft edges.
  void Box(double x, double y, double width, double height, const Color& color, double radius = 0,
           double opacity = 1);
  void Paste(int x, int y, const Image& picture);

 private:
  void Blend(int x, int y, const Color& color, double coverage);
  Image& image_;
  const Fonts& fonts_;
};

}  // namespace dexremoe
