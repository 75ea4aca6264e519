// From linear light to the image file.
#pragma once

#include <vector>

#include "io/png.h"

namespace dexremoe {

// Averages factor x factor blocks of linear RGBA floats (bottom row first, factor times as wide and
// high as the image) and encodes them as 8-bit sRGB, top row first.
Image Downsample(const std::vector<float>& pixels, int width, int height, int factor);

}  // namespace dexremoe
