// PPM and PGM, binary (P6, P5): http://netpbm.sourceforge.net/doc/ppm.html
#include <fmt/format.h>

#include "common/error/error.h"
#include "common/image/codecs/image_codec.h"
#include "common/image/codecs/pnm_header.h"
#include "common/image/codecs/rgba8.h"
#include "common/image/codecs/tone_mapping.h"

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
  const double file_pixels = 3.0 * file.width * file.height * sample_bytes(file.max_value);
  Image image = allocate_image(file.width, file.height, file_pixels, bytes.size());
  dequantize(file.samples, file.max_value, gamma2_curve, image);
  return image;
}

}  // namespace

Rgba8Image decode_ppm_rgba8(std::string_view bytes) {
  const std::size_t channels = bytes.starts_with("P5") ? 1 : 3;
  const PnmSamples file = read_samples(bytes, static_cast<int>(channels));
  const auto* samples = reinterpret_cast<const unsigned char*>(file.samples.data());
  const bool wide = sample_bytes(file.max_value) == 2;
  const auto value = [&](std::size_t i) {
    const int sample = wide ? samples[2 * i] * 256 + samples[2 * i + 1] : samples[i];
    if (sample > file.max_value) {
      throw Error(fmt::format("sample {} exceeds the file's maximum {}", sample, file.max_value));
    }
    return std::byte(static_cast<unsigned char>(255.0 * sample / file.max_value + 0.5));
  };
  Rgba8Image image{file.width, file.height, {}};
  image.rgba.resize(std::size_t{4} * file.width * file.height, std::byte{255});
  for (std::size_t i = 0; i < image.rgba.size(); ++i) {
    if (i % 4 < 3) image.rgba[i] = value(channels == 1 ? i / 4 : 3 * (i / 4) + i % 4);
  }
  return image;
}

const ImageCodec ppm_codec{".ppm", encode_ppm, decode_ppm};

}  // namespace pt
