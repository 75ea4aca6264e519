#include "io/png.h"

#include <png.h>

#include <string_view>

#include "base/check.h"
#include "base/error.h"
#include "io/atomic_file.h"

namespace dexremoe {
namespace {

// libpng's simplified interface keeps what it allocated in here until it is freed.
struct PngHandle {
  png_image image{};
  PngHandle() { image.version = PNG_IMAGE_VERSION; }
  ~PngHandle() { png_image_free(&image); }
};

}  // namespace

Image::Image(int width, int height, std::uint8_t r, std::uint8_t g, std::uint8_t b)
    : width(width), height(height), rgb(std::size_t(3) * width * height) {
  for (std::size_t i = 0; i < rgb.size(); i += 3) {
    rgb[i] = r;
    rgb[i + 1] = g;
    rgb[i + 2] = b;
  }
}

void WritePng(const std::string& path, const Image& image) {
  DEX_CHECK_EQ(image.rgb.size(), std::size_t(3) * image.width * image.height);
  if (image.rgb.empty()) Fail("{}: an image without pixels", path);
  PngHandle handle;
  handle.image.width = image.width;
  handle.image.height = image.height;
  handle.image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = 0;
  if (!png_image_write_get_memory_size(handle.image, size, 0, image.rgb.data(), 0, nullptr))
    Fail("{}: {}", path, handle.image.message);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&handle.image, bytes.data(), &size, 0, image.rgb.data(), 0,
                                 nullptr))
    Fail("{}: {}", path, handle.image.message);
  WriteFile(path, std::string_view(bytes).substr(0, size));
}

Image ReadPng(const std::string& path) {
  const std::string bytes = ReadFile(path);
  PngHandle handle;
  if (!png_image_begin_read_from_memory(&handle.image, bytes.data(), bytes.size()))
    Fail("{}: expected a PNG image: {}", path, handle.image.message);
  handle.image.format = PNG_FORMAT_RGB;
  Image image(int(handle.image.width), int(handle.image.height), 0, 0, 0);
  const png_color white = {255, 255, 255};
  if (!png_image_finish_read(&handle.image, &white, image.rgb.data(), 0, nullptr))
    Fail("{}: a damaged PNG image: {}", path, handle.image.message);
  return image;
}

}  // namespace dexremoe
