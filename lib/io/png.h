// 8-bit RGB images and PNG files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dexremoe {

// Interleaved sRGB, row 0 on top.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // [height, width, 3]

  Image() = default;
  // Filled with one colour.
  Image(int width, int height, std::uint8_t r, std::uint8_t g, std::uint8_t b);
  std::uint8_t* at(int x, int y) { return rgb.data() + 3 * (std::size_t(y) * width + x); }
  const std::uint8_t* at(int x, int y) const {
    return rgb.data() + 3 * (std::size_t(y) * width + x);
  }
};

// Written whole or not at all; equal images give equal bytes. Throws Error.
void WritePng(const std::string& path, const Image& image);
// Any PNG, converted to 8-bit RGB (transparency over white). Throws Error.
Image ReadPng(const std::string& path);

}  // namespace dexremoe
