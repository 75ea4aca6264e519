#include "render/canvas.h"

#include <algorithm>
#include <cmath>

#include "render/font.h"

namespace dexremoe {
namespace {

constexpr char kRegular[] = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
constexpr char kBold[] = "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf";

// Signed distance to a rounded box with the given half sides about the origin.
double RoundedBox(double x, double y, double half_width, double half_height, double radius) {
  const double dx = std::abs(x) - half_width + radius, dy = std::abs(y) - half_height + radius;
  return std::min(std::max(dx, dy), 0.0) + std::hypot(std::max(dx, 0.0), std::max(dy, 0.0)) -
         radius;
}

}  // namespace

struct Fonts::Impl {
  Font regular{kRegular};
  Font bold{kBold};
  Font& Of(const TextStyle& style) { return style.bold ? bold : regular; }
};

Fonts::Fonts() : impl_(std::make_unique<Impl>()) {}
Fonts::~Fonts() = default;

double Fonts::Width(std::string_view text, const TextStyle& style) const {
  double width = 0;
  for (char32_t c : DecodeUtf8(text)) width += impl_->Of(style).Advance(c, style.size);
  return width;
}

std::string Fonts::Fit(std::string_view text, const TextStyle& style, double width) const {
  if (Width(text, style) <= width) return std::string(text);
  for (std::size_t n = text.size(); n > 0; --n) {
    const bool inside = n < text.size() && (text[n] & 0xc0) == 0x80;  // amid a character
    const std::string shorter = std::string(text.substr(0, n)) + "…";
    if (!inside && Width(shorter, style) <= width) return shorter;
  }
  return {};
}

void Canvas::Blend(int x, int y, const Color& color, double coverage) {
  if (x < 0 || y < 0 || x >= image_.width || y >= image_.height || coverage <= 0) return;
  std::uint8_t* pixel = image_.at(x, y);
  for (int k = 0; k < 3; ++k)
    pixel[k] = std::uint8_t(std::lround(pixel[k] + coverage * (255.0 * color[k] - pixel[k])));
}

void Canvas::Text(double x, double y, std::string_view text, const TextStyle& style) {
  Font& font = fonts_.impl_->Of(style);
  double pen = x;
  if (style.align != Align::kLeft)
    pen -= fonts_.Width(text, style) * (style.align == Align::kCenter ? 0.5 : 1);
  const int baseline = int(std::lround(y));
  for (char32_t character : DecodeUtf8(text)) {
    const double whole = std::floor(pen);
    const GlyphImage glyph = font.Glyph(character, style.size, pen - whole);
    for (int row = 0; row < glyph.height; ++row)
      for (int column = 0; column < glyph.width; ++column)
        Blend(int(whole) + glyph.left + column, baseline - glyph.top + row, style.color,
              glyph.coverage[std::size_t(row) * glyph.width + column] / 255.0);
    pen += glyph.advance;
  }
}

void Canvas::Box(double x, double y, double width, double height, const Color& color, double radius,
                 double opacity) {
  const double cx = x + width / 2, cy = y + height / 2;
  const double round = std::min({radius, width / 2, height / 2});
  for (int j = int(std::floor(y)); j < std::ceil(y + height); ++j)
    for (int i = int(std::floor(x)); i < std::ceil(x + width); ++i) {
      const double d = RoundedBox(i + 0.5 - cx, j + 0.5 - cy, width / 2, height / 2, round);
      Blend(i, j, color, opacity * std::clamp(0.5 - d, 0.0, 1.0));
    }
}

void Canvas::Paste(int x, int y, const Image& picture) {
  const int left = std::max(x, 0), right = std::min(x + picture.width, image_.width);
  for (int j = std::max(y, 0); j < std::min(y + picture.height, image_.height); ++j)
    if (left < right)
      std::copy_n(picture.at(left - x, j - y), 3 * std::size_t(right - left), image_.at(left, j));
}

}  // namespace dexremoe
