// PPM and PGM, binary (P6, P5): http://netpbm.sourceforge.net/doc/ppm.html
#include <fmt/format.h>

#include <type_traits>

#include "common/error/error.h"
#include "common/image/codecs/image_codec.h"
#include "common/image/codecs/integer_image.h"
#include "common/image/codecs/pnm_header.h"
#include "common/image/tone_mapping.h"

namespace pt {
namespace {

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

}  // namespace pt
