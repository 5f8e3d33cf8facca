// PPM, binary (P6): http://netpbm.sourceforge.net/doc/ppm.html
#include <fmt/format.h>

#include <algorithm>

#include "common/error.h"
#include "common/image/image_codec.h"
#include "common/image/tone_mapping.h"

namespace pt {
namespace {

bool is_space(char c) { return c == ' ' || ('\t' <= c && c <= '\r'); }

class HeaderReader {
 public:
  explicit HeaderReader(std::string_view bytes) : rest_(bytes) {
    if (!rest_.starts_with("P6")) throw Error("not a binary PPM: it does not begin with P6");
    rest_.remove_prefix(2);
  }

  /// The next number, which white space or a comment must precede.
  int number(const char* name) {
    const std::size_t before = rest_.size();
    skip_space();
    int value = 0, digits = 0;
    for (; !rest_.empty() && '0' <= rest_[0] && rest_[0] <= '9'; rest_.remove_prefix(1), ++digits) {
      value = std::min(10 * value + (rest_[0] - '0'), 1'000'000);  // large enough to be refused
    }
    if (rest_.empty()) throw Error(fmt::format("truncated in the header, at the {}", name));
    if (digits == 0 || before == rest_.size() + digits) {
      throw Error(fmt::format("corrupted header: expected a number, the {}", name));
    }
    if (value < 1 || value > 65535) {
      throw Error(fmt::format("{} out of range, expected 1 to 65535", name));
    }
    return value;
  }

  /// What follows the single white space that ends the header.
  std::string_view samples() {
    if (!is_space(rest_[0])) throw Error("corrupted header: expected white space after maxval");
    return rest_.substr(1);
  }

 private:
  void skip_space() {
    while (!rest_.empty() && (is_space(rest_[0]) || rest_[0] == '#')) {
      const bool comment = rest_[0] == '#';
      rest_.remove_prefix(comment ? std::min(rest_.find_first_of("\r\n"), rest_.size()) : 1);
    }
  }

  std::string_view rest_;
};

std::string encode_ppm(const Image& image, const ImageMetadata&, const ToneMapping& tone_mapping) {
  return fmt::format("P6\n{} {}\n255\n", image.width, image.height) +
         quantize(image, tone_mapping, gamma2_curve);
}

Image decode_ppm(std::string_view bytes, ImageMetadata*) {
  HeaderReader header(bytes);
  const int width = header.number("width");
  const int height = header.number("height");
  const int max_value = header.number("maxval");
  const std::string_view samples = header.samples();
  const std::size_t expected_bytes = std::size_t{3} * width * height * sample_bytes(max_value);
  if (samples.size() < expected_bytes) {
    throw Error(fmt::format("truncated: {}x{} pixels need {} bytes, found {}", width, height,
                            expected_bytes, samples.size()));
  }
  Image image = allocate_image(width, height, static_cast<double>(expected_bytes), bytes.size());
  dequantize(samples, max_value, gamma2_curve, image);
  return image;
}

}  // namespace

const ImageCodec ppm_codec{".ppm", encode_ppm, decode_ppm};

}  // namespace pt
