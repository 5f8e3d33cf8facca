// The formats of Netpbm: PPM and PGM, binary (P6, P5; http://netpbm.sourceforge.net/doc/ppm.html),
// and portable float maps (https://www.pauldebevec.com/Research/HDR/PFM/).
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include "common/error/error.h"
#include "common/image/codecs/image_codec.h"
#include "common/image/tone_mapping.h"

namespace pt {
namespace {

/// The header that PPM, PGM and PFM share: words separated by white space and comments.
class PnmHeader {
 public:
  /// `bytes` begin with the two letters of the format.
  explicit PnmHeader(std::string_view bytes) : rest_(bytes.substr(2)) {}

  /// The next number, which white space or a comment must precede.
  int number(const char* name) {
    const std::size_t before = rest_.size();
    skip_space();
    int value = 0, digits = 0;
    for (; !rest_.empty() && '0' <= rest_[0] && rest_[0] <= '9'; rest_.remove_prefix(1), ++digits) {
      value = std::min(10 * value + (rest_[0] - '0'), 1'000'000);  // large enough to be refused
    }
    if (rest_.empty()) throw Error(fmt::format("truncated in the header, at the {}", name));
    if (digits == 0 || before == rest_.size() + static_cast<std::size_t>(digits)) {
      throw Error(fmt::format("corrupted header: expected a number, the {}", name));
    }
    if (value < 1 || value > 65535) {
      throw Error(fmt::format("{} out of range, expected 1 to 65535", name));
    }
    return value;
  }

  /// The next word, whatever it is.
  std::string_view word() {
    skip_space();
    const auto end = std::ranges::find_if(rest_, is_space);
    const std::string_view taken = rest_.substr(0, static_cast<std::size_t>(end - rest_.begin()));
    rest_.remove_prefix(taken.size());
    return taken;
  }

  /// What follows the single white space that ends the header. Throws Error unless there are
  /// `size` bytes or more.
  std::string_view samples(const char* last, int width, int height, std::size_t size) {
    if (rest_.empty()) throw Error("truncated: the header does not end");
    if (!is_space(rest_[0])) {
      throw Error(fmt::format("corrupted header: expected white space after {}", last));
    }
    const std::string_view bytes = rest_.substr(1);
    if (bytes.size() < size) {
      throw Error(fmt::format("truncated: {}x{} pixels need {} bytes, found {}", width, height,
                              size, bytes.size()));
    }
    return bytes;
  }

 private:
  static bool is_space(char c) { return c == ' ' || ('\t' <= c && c <= '\r'); }

  void skip_space() {
    while (!rest_.empty() && (is_space(rest_[0]) || rest_[0] == '#')) {
      const bool comment = rest_[0] == '#';
      rest_.remove_prefix(comment ? std::min(rest_.find_first_of("\r\n"), rest_.size()) : 1);
    }
  }

  std::string_view rest_;
};

struct PnmSamples {
  int width, height, max_value;
  std::string_view samples;
};

PnmSamples read_samples(std::string_view bytes, int channels) {
  PnmHeader header(bytes);
  const int width = header.number("width"), height = header.number("height");
  const int max_value = header.number("maxval");
  const std::size_t size = std::size_t{1} * channels * width * height * sample_bytes(max_value);
  return {width, height, max_value, header.samples("maxval", width, height, size)};
}

std::string encode_ppm(const Image& image, const ImageMetadata&, const ToneMapping& tone_mapping) {
  return fmt::format("P6\n{} {}\n255\n", image.width, image.height) +
         quantize(image, tone_mapping, gamma2_curve);
}

Image decode_ppm(std::string_view bytes, ImageMetadata*) {
  if (!bytes.starts_with("P6")) throw Error("not a binary PPM: it does not begin with P6");
  const PnmSamples file = read_samples(bytes, 3);
  Image image = allocate_image({file.width, file.height}, bytes.size());
  dequantize(file.samples, file.max_value, gamma2_curve, image);
  return image;
}

}  // namespace

IntegerImage decode_ppm_integers(std::string_view bytes) {
  const std::size_t channels = bytes.starts_with("P5") ? 1 : 3;
  const PnmSamples file = read_samples(bytes, static_cast<int>(channels));
  const auto* samples = reinterpret_cast<const unsigned char*>(file.samples.data());
  const bool is_wide = sample_bytes(file.max_value) == 2;
  const double pixels = 1.0 * file.width * file.height;
  check_image_size({file.width, file.height, 0, (is_wide ? 8 : 4) * pixels}, bytes.size());
  const double white = is_wide ? 65535.0 : 255.0;
  const auto value = [&](std::size_t i) {
    const int sample = is_wide ? samples[2 * i] * 256 + samples[2 * i + 1] : samples[i];
    if (sample > file.max_value) {
      throw Error(fmt::format("sample {} exceeds the file's maximum {}", sample, file.max_value));
    }
    return static_cast<int>(white * sample / file.max_value + 0.5);
  };
  const auto fill = [&](auto& rgba) {
    using Value = std::remove_reference_t<decltype(rgba[0])>;
    rgba.resize(std::size_t{4} * file.width * file.height, Value(white));
    for (std::size_t i = 0; i < rgba.size(); ++i) {
      if (i % 4 < 3) rgba[i] = Value(value(channels == 1 ? i / 4 : 3 * (i / 4) + i % 4));
    }
  };
  IntegerImage image{file.width, file.height, {}};
  is_wide ? fill(image.rgba16) : fill(image.rgba);
  if (is_wide) image.narrow();
  return image;
}

const ImageCodec ppm_codec{".ppm", encode_ppm, decode_ppm};

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
