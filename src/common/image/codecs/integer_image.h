// Images of integers, and the decoders that only textures need.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "common/image/image.h"

namespace pt {

/// Values as in the file, 4 * width * height, row by row from the top.
struct IntegerImage {
  int width = 0;
  int height = 0;
  std::vector<std::byte> rgba;             ///< of 8 bits, as textures keep them
  std::vector<std::uint16_t> rgba16 = {};  ///< instead, where 8 bits do not hold all values

  /// Moves the values of rgba16 to rgba if each of them is a multiple of 257: then it is one of 8
  /// bits, of the same share of white.
  void narrow();
};

// All throw Error, or another std::exception, for any bytes that are not a complete image.

/// Any PNG.
IntegerImage decode_png_integers(std::string_view bytes);

/// PPM or PGM, P6 or P5; a maximum below 255 is brought to that, a larger one to 65535.
IntegerImage decode_ppm_integers(std::string_view bytes);

/// Baseline or progressive JPEG, grey, YCbCr, CMYK or YCCK; ink is taken for a filter of red, green
/// or blue, as there is no profile of the press.
IntegerImage decode_jpeg(std::string_view bytes);

/// BMP or TGA (which has no signature), by stb_image.
IntegerImage decode_bmp_or_tga(std::string_view bytes);

/// Radiance's .hdr, by stb_image: linear.
Image decode_hdr(std::string_view bytes);

/// PFM, colour (PF) or grey (Pf): linear.
Image decode_pfm(std::string_view bytes);

}  // namespace pt
