// Portable float maps: https://www.pauldebevec.com/Research/HDR/PFM/
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

#include "common/error/error.h"
#include "common/image/codecs/image_codec.h"
#include "common/image/codecs/integer_image.h"
#include "common/image/codecs/pnm_header.h"

namespace pt {
namespace {

/// Below 0 for little-endian samples; its size is a factor.
float next_scale(PnmHeader& header) {
  const std::string_view text = header.word();
  float scale = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), scale);
  if (error != std::errc() || end != text.data() + text.size() || scale == 0.0f ||
      !std::isfinite(scale)) {
    throw Error("corrupted header: expected a number other than 0, the scale");
  }
  return scale;
}

float float_at(const char* bytes, bool little_endian) {
  unsigned char b[4];
  std::memcpy(b, bytes, 4);
  const auto word = [&](int i0, int i1, int i2, int i3) {
    return std::uint32_t{b[i0]} | std::uint32_t{b[i1]} << 8 | std::uint32_t{b[i2]} << 16 |
           std::uint32_t{b[i3]} << 24;
  };
  return std::bit_cast<float>(little_endian ? word(0, 1, 2, 3) : word(3, 2, 1, 0));
}

}  // namespace

Image decode_pfm(std::string_view bytes) {
  const std::size_t channels = bytes.starts_with("Pf") ? 1 : 3;
  PnmHeader header(bytes);
  const int width = header.number("width"), height = header.number("height");
  const float scale = next_scale(header);
  const std::size_t row_bytes = sizeof(float) * channels * static_cast<std::size_t>(width);
  const std::size_t size = row_bytes * static_cast<std::size_t>(height);
  const std::string_view samples = header.samples("the scale", width, height, size);
  Image image = allocate_image({width, height}, bytes.size());
  for (int y = 0; y < height; ++y) {
    // From the foot to the head.
    const char* row = samples.data() + static_cast<std::size_t>(height - 1 - y) * row_bytes;
    for (std::size_t i = 0; i < 3 * static_cast<std::size_t>(width); ++i) {
      const std::size_t sample = channels == 1 ? i / 3 : i;
      const float value = float_at(row + sizeof(float) * sample, scale < 0.0f);
      image.pixel(0, y)[i] = std::abs(scale) * value;
    }
  }
  return image;
}

}  // namespace pt
