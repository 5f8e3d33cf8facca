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

/// What a header announces of an image.
struct AnnouncedSize {
  std::int64_t width = 0, height = 0;
  double stored_bytes = 0;    ///< of the pixels as the file stores them, decompressed
  double decoding_bytes = 0;  ///< of memory that decoding them takes, the result included
};

/// To be called before anything is allocated for an image. Throws Error unless it has at most 65535
/// pixels a side, at most 2^28 pixels or 256 for each byte of the file, a file of `file_bytes` can
/// hold it, and the memory for it is free.
void check_image_size(const AnnouncedSize& size, std::size_t file_bytes);

/// A black image, allocated only after check_image_size; `decoding_bytes` without the image's own.
Image allocate_image(AnnouncedSize size, std::size_t file_bytes);

}  // namespace pt
