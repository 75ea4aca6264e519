// Outline fonts. The only place that includes FreeType.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace dexremoe {

// One glyph as coverage 0..255, and where it goes relative to the pen on the baseline.
struct GlyphImage {
  int left = 0, top = 0;  // pixels to the right of the pen and above the baseline
  int width = 0, height = 0;
  double advance = 0;                  // pixels
  std::vector<std::uint8_t> coverage;  // [height, width]
};

class Font {
 public:
  // `path`: a TrueType or OpenType file. Throws Error naming it.
  explicit Font(const std::string& path);
  ~Font();
  Font(const Font&) = delete;
  Font& operator=(const Font&) = delete;

  // `size` is the height of an em in pixels; `offset` in [0, 1) shifts the outline to the right. A
  // character that the font lacks gives its box.
  GlyphImage Glyph(char32_t character, double size, double offset);
  double Advance(char32_t character, double size);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Characters of UTF-8 text; broken bytes become U+FFFD.
std::u32string DecodeUtf8(std::string_view text);

}  // namespace dexremoe
