#include "common/image/tone_mapping.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/error/error.h"

namespace pt {
namespace {

float encode_srgb(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

float decode_srgb(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

float encode_gamma2(float linear) { return std::sqrt(linear); }

float decode_gamma2(float encoded) { return encoded * encoded; }

float clamp_unit(float value) {
  if (!(value > 0)) return 0;  // NaN too
  return value < 1 ? value : 1;
}

}  // namespace

const TransferCurve srgb_curve{encode_srgb, decode_srgb};
const TransferCurve gamma2_curve{encode_gamma2, decode_gamma2};

std::string quantize(const Image& image, const ToneMapping& tone_mapping,
                     const TransferCurve& curve) {
  const float scale = std::exp2(tone_mapping.exposure);
  std::string bytes(image.rgb.size(), '\0');
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, bytes.size(), 1 << 14), [&](auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const float encoded = curve.encode(clamp_unit(image.rgb[i] * scale));
      bytes[i] = static_cast<char>(static_cast<unsigned char>(255 * encoded + 0.5f));
    }
  });
  return bytes;
}

void dequantize(std::string_view samples, int max_value, const TransferCurve& curve, Image& image) {
  std::vector<float> decoded(static_cast<std::size_t>(max_value) + 1);
  for (std::size_t i = 0; i < decoded.size(); ++i) {
    decoded[i] = curve.decode(static_cast<float>(i) / static_cast<float>(max_value));
  }
  const auto* bytes = reinterpret_cast<const unsigned char*>(samples.data());
  const bool wide = sample_bytes(max_value) == 2;
  for (std::size_t i = 0; i < image.rgb.size(); ++i) {
    const std::size_t sample = wide ? bytes[2 * i] * 256u + bytes[2 * i + 1] : bytes[i];
    if (sample >= decoded.size()) {
      throw Error(fmt::format("sample {} exceeds the file's maximum {}", sample, max_value));
    }
    image.rgb[i] = decoded[sample];
  }
}

namespace {

constexpr double middle_grey = 0.18;
constexpr double bright_share = 0.01;
constexpr float display_range = 1000.0f;

/// The luminances of the pixels that are not black, ascending.
std::vector<float> luminances(const Image& image) {
  std::vector<float> values;
  for (std::size_t i = 0; i + 2 < image.rgb.size(); i += 3) {
    const float* p = image.rgb.data() + i;
    const float y = 0.2126f * p[0] + 0.7152f * p[1] + 0.0722f * p[2];
    if (y > 0.0f && std::isfinite(y)) values.push_back(y);
  }
  std::ranges::sort(values);
  return values;
}

}  // namespace

float measure_exposure(const Image& image) {
  const std::vector<float> values = luminances(image);
  if (values.empty()) return 0.0f;
  const auto dropped = static_cast<std::size_t>(bright_share * static_cast<double>(values.size()));
  const auto end = values.end() - static_cast<std::ptrdiff_t>(dropped);
  const auto begin = std::lower_bound(values.begin(), end, end[-1] / display_range);
  double sum = 0;
  for (auto value = begin; value != end; ++value) sum += std::log2(static_cast<double>(*value));
  const double stops = std::log2(middle_grey) - sum / static_cast<double>(end - begin);
  return static_cast<float>(std::clamp(stops, -100.0, 100.0));
}

}  // namespace pt
