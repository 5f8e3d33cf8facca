// Reading and writing images. A file is complete or untouched: atomic_file.h writes it.
#pragma once

#include <map>
#include <string>

#include "common/image/image.h"
#include "common/image/tone_mapping.h"

namespace pt {

/// Name -> value, stored as string attributes in an EXR header and as tEXt chunks in a PNG (iTXt
/// where a value is not ASCII, taken as UTF-8); a PPM has no place for it. Names are 1 to 79
/// printable ASCII characters and none that OpenEXR itself defines; values have no zero byte.
using ImageMetadata = std::map<std::string, std::string>;

/// The lower case ending of an image's name: ".exr", ".png" or ".ppm". Throws Error for others.
std::string image_ending(const std::string& path);

/// Throws Error when `path`'s ending is not .exr, .png or .ppm or a file cannot be created in its
/// folder. Leaves nothing behind and touches no existing file: called before any work is done.
void check_image_path(const std::string& path);

/// Writes linear float RGB and the layers (.exr), sRGB 8-bit RGB (.png) or gamma-2 8-bit binary RGB
/// (.ppm). The ending may be in capitals. Throws Error naming the file.
void write_image(const std::string& path, const Image& image, const ImageMetadata& metadata,
                 const ToneMapping& tone_mapping = {});

/// Reads .exr (flat, channels R, G, B or Y alone, of any type), .png (any kind; alpha is dropped)
/// or .ppm (P6) into linear RGB; integers are decoded with the curve that write_image uses,
/// exposure 0, whatever gamma the file announces. Fills `metadata` where given. Throws Error naming
/// the file for one that is missing, of another format, truncated, corrupted or larger than 65535
/// pixels a side.
Image read_image(const std::string& path, ImageMetadata* metadata = nullptr);

/// As read_image; an .exr with its layers, the channels LAYER.C, which are floats or whole numbers.
Image read_image_with_layers(const std::string& path, ImageMetadata& metadata);

/// Reads an .exr as read_image does, with its layers of whole numbers (ImageLayer::numbers) whose
/// names begin with `prefix`.
Image read_image_with_numbers(const std::string& path, const std::string& prefix,
                              ImageMetadata& metadata);

}  // namespace pt
