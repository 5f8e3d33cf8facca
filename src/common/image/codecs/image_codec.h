// One image file format: between an Image and the bytes of a whole file. Codecs do not know file
// names: image_io puts them into the errors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

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

/// The image of an EXR and all of its layers.
Image decode_exr_layers(std::string_view bytes, ImageMetadata* metadata);

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

// Images of integers, and the decoders that only textures need. The decoders throw Error, or
// another std::exception, for any bytes that are not a complete image.

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
