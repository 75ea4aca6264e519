#include "render/font.h"

#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H

#include <cmath>

#include "base/error.h"

namespace dexremoe {

struct Font::Impl {
  FT_Library library = nullptr;
  FT_Face face = nullptr;
  double size = 0;

  ~Impl() {
    if (face != nullptr) FT_Done_Face(face);
    if (library != nullptr) FT_Done_FreeType(library);
  }
  // Light hinting aligns stems vertically only, so that widths scale and text can be placed between
  // pixels.
  bool Load(char32_t character, double wanted) {
    if (wanted != size) FT_Set_Char_Size(face, 0, FT_F26Dot6(std::lround(64 * wanted)), 72, 72);
    size = wanted;
    return FT_Load_Char(face, character, FT_LOAD_TARGET_LIGHT | FT_LOAD_NO_BITMAP) == 0;
  }
};

Font::Font(const std::string& path) : impl_(std::make_unique<Impl>()) {
  if (FT_Init_FreeType(&impl_->library) != 0) Fail("FreeType cannot be started");
  if (FT_New_Face(impl_->library, path.c_str(), 0, &impl_->face) != 0)
    Fail("{}: expected a font file, found none (Debian package fonts-dejavu-core)", path);
}

Font::~Font() = default;

double Font::Advance(char32_t character, double size) {
  if (!impl_->Load(character, size)) return 0;
  return double(impl_->face->glyph->linearHoriAdvance) / 65536.0;
}

GlyphImage Font::Glyph(char32_t character, double size, double offset) {
  GlyphImage glyph;
  if (!impl_->Load(character, size)) return glyph;
  const FT_GlyphSlot slot = impl_->face->glyph;
  glyph.advance = double(slot->linearHoriAdvance) / 65536.0;
  FT_Outline_Translate(&slot->outline, FT_Pos(std::lround(64 * offset)), 0);
  if (FT_Render_Glyph(slot, FT_RENDER_MODE_NORMAL) != 0) return glyph;
  const FT_Bitmap& bitmap = slot->bitmap;
  glyph.left = slot->bitmap_left;
  glyph.top = slot->bitmap_top;
  glyph.width = int(bitmap.width);
  glyph.height = int(bitmap.rows);
  for (int y = 0; y < glyph.height; ++y) {
    const std::uint8_t* row = bitmap.buffer + std::ptrdiff_t(y) * bitmap.pitch;
    glyph.coverage.insert(glyph.coverage.end(), row, row + glyph.width);
  }
  return glyph;
}

std::u32string DecodeUtf8(std::string_view text) {
  std::u32string characters;
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<std::uint8_t>(text[i]);
    const int length = first < 0x80       ? 1
                       : first >> 5 == 6  ? 2
                       : first >> 4 == 14 ? 3
                       : first >> 3 == 30 ? 4
                                          : 0;
    char32_t character = length == 1 ? first : first & (0x7f >> length);
    bool good = length > 0 && i + length <= text.size();
    for (int k = 1; good && k < length; ++k) {
      const auto next = static_cast<std::uint8_t>(text[i + k]);
      good = next >> 6 == 2;
      character = character << 6 | (next & 0x3f);
    }
    characters.push_back(good ? character : U'\uFFFD');
    i += good ? length : 1;
  }
  return characters;
}

}  // namespace dexremoe
