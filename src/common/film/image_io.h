// Reading and writing images. A file is complete or untouched: it is written beside its place
// under a temporary name and renamed.
#pragma once

#include <map>
#include <string>

#include "common/film/image.h"

namespace pt {

/// Name -> value, stored as string attributes in an EXR header and tEXt chunks in a PNG.
using ImageMetadata = std::map<std::string, std::string>;

/// How linear radiance becomes 8 bits: multiplied by 2^exposure, clamped to [0, 1], then encoded
/// with the sRGB curve (PNG) or gamma 2 (PPM, as in the paper).
struct ToneMapping {
  float exposure = 0.0f;  ///< stops
};

/// Throws Error when `path`'s ending is not .exr, .png or .ppm or a file cannot be created in its
/// folder. Leaves nothing behind and touches no existing file: called before any work is done.
void check_image_path(const std::string& path);

/// Writes linear float RGB (.exr), sRGB 8-bit RGB (.png) or gamma-2 8-bit binary RGB (.ppm).
/// Throws Error naming the file.
void write_image(const std::string& path, const Image& image, const ImageMetadata& metadata,
                 const ToneMapping& tone_mapping = {});

/// Reads .exr, .png (8 or 16 bit) or .ppm (P6) into linear RGB; 8-bit values are decoded with the
/// curve that write_image uses, exposure 0. Fills `metadata` where given. Throws Error.
Image read_image(const std::string& path, ImageMetadata* metadata = nullptr);

}  // namespace pt
