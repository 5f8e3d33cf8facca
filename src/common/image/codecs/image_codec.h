// One image file format: between an Image and the bytes of a whole file. Codecs do not know file
// names: image_io puts them into the errors.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/image/codecs/image_io.h"
#include "common/image/image.h"

namespace pt {

inline constexpr int max_image_size = 65535;  ///< pixels, of width and height

struct ImageCodec {
  std::string_view ending;  ///< lower case, with the dot
  std::string (*encode)(const Image& image, const ImageMetadata& metadata,
                        const ToneMapping& tone_mapping);
  /// Fills `metadata` (never null). Throws Error, or another std::exception, for any bytes that
  /// are not a complete image.
  Image (*decode)(std::string_view bytes, ImageMetadata* metadata);
};

/// The image of an EXR and those of its layers of whole numbers whose names begin with `prefix`.
Image decode_exr_numbers(std::string_view bytes, const std::string& prefix,
                         ImageMetadata* metadata);

extern const ImageCodec exr_codec;  ///< float, ZIP-compressed, metadata as string attributes
extern const ImageCodec png_codec;  ///< sRGB, metadata as text chunks
extern const ImageCodec ppm_codec;  ///< gamma 2, no metadata

/// As png_codec, for who waits: a larger file, several times as fast. Throws Error.
std::string encode_png_fast(const Image& image, const ToneMapping& tone_mapping);

/// Throws Error unless a file of `file_bytes` can hold an image of this size: at most 65535 pixels
/// a side, `decoded_bytes` of pixels as the file stores them, decompressed.
void check_image_size(std::int64_t width, std::int64_t height, double decoded_bytes,
                      std::size_t file_bytes);

/// A black image, allocated only after check_image_size has found its size believable.
Image allocate_image(std::int64_t width, std::int64_t height, double decoded_bytes,
                     std::size_t file_bytes);

}  // namespace pt
