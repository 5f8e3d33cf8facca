// Images of 8-bit integers, as textures keep them, and the decoders that only textures need.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "common/image/image.h"

namespace pt {

struct Rgba8Image {
  int width = 0;
  int height = 0;
  std::vector<std::byte> rgba;  ///< 4 * width * height, row by row from the top, as in the file
};

// All throw Error, or another std::exception, for any bytes that are not a complete image.

/// Any PNG; 16 bits are rounded to 8.
Rgba8Image decode_png_rgba8(std::string_view bytes);

/// PPM or PGM, P6 or P5; more than 8 bits are rounded to 8.
Rgba8Image decode_ppm_rgba8(std::string_view bytes);

/// Baseline or progressive JPEG, grey, YCbCr, CMYK or YCCK; ink is taken for a filter of red, green
/// or blue, as there is no profile of the press.
Rgba8Image decode_jpeg(std::string_view bytes);

/// BMP or TGA (which has no signature), by stb_image.
Rgba8Image decode_bmp_or_tga(std::string_view bytes);

/// Radiance's .hdr, by stb_image: linear.
Image decode_hdr(std::string_view bytes);

/// PFM, colour (PF) or grey (Pf): linear.
Image decode_pfm(std::string_view bytes);

}  // namespace pt
