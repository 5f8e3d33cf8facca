#include "common/image/compare/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "common/error/error.h"
#include "common/image/codecs/image_io.h"
#include "common/image/tone_mapping.h"

namespace pt {
namespace {

bool same_bits(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

/// |a - b|; 0 for equal bits and infinite for other pairs with a value that is not finite, so that
/// no NaN gets into the sums.
double distance(float a, float b) {
  if (same_bits(a, b)) return 0;
  if (!std::isfinite(a) || !std::isfinite(b)) return std::numeric_limits<double>::infinity();
  return std::abs(static_cast<double>(a) - static_cast<double>(b));
}

double relative_square(double error, float reference) {
  if (error == 0 || std::isinf(error)) return error;
  return error * error / (static_cast<double>(reference) * reference + 1e-2);
}

}  // namespace

ImageDifference compare_images(const Image& a, const Image& b, double tolerance) {
  if (a.width != b.width || a.height != b.height) {
    throw Error(
        fmt::format("the sizes differ: {}x{} and {}x{}", a.width, a.height, b.width, b.height));
  }
  ImageDifference difference;
  double sum = 0, relative_sum = 0;
  for (std::size_t pixel = 0; pixel < b.rgb.size(); pixel += 3) {
    bool differs = false;
    double largest = 0;
    for (std::size_t i = pixel; i < pixel + 3; ++i) {
      const double error = distance(a.rgb[i], b.rgb[i]);
      differs = differs || !same_bits(a.rgb[i], b.rgb[i]);
      largest = std::max(largest, error);
      sum += error * error;
      relative_sum += relative_square(error, b.rgb[i]);
    }
    difference.differing_pixels += differs;
    difference.pixels_past_tolerance += largest > tolerance;
    difference.largest = std::max(difference.largest, largest);
  }
  const double values = static_cast<double>(std::max<std::size_t>(b.rgb.size(), 1));
  difference.rmse = std::sqrt(sum / values);
  difference.relative_mse = relative_sum / values;
  return difference;
}

namespace {

// sRGB values, evenly spaced.
constexpr std::array<std::array<float, 3>, 6> ramp = {{{0.00f, 0.00f, 0.02f},
                                                       {0.26f, 0.07f, 0.43f},
                                                       {0.62f, 0.15f, 0.48f},
                                                       {0.92f, 0.32f, 0.31f},
                                                       {0.99f, 0.64f, 0.25f},
                                                       {0.99f, 0.99f, 0.75f}}};

std::array<float, 3> color_of(float value) {
  const float position = std::clamp(value, 0.0f, 1.0f) * (ramp.size() - 1);
  const std::size_t low = std::min(static_cast<std::size_t>(position), ramp.size() - 2);
  const float part = position - static_cast<float>(low);
  std::array<float, 3> color{};
  for (std::size_t c = 0; c < 3; ++c) {
    color[c] = srgb_curve.decode((1 - part) * ramp[low][c] + part * ramp[low + 1][c]);
  }
  return color;
}

}  // namespace

Image false_colors(std::span<const float> values, int width, int height) {
  Image image{width, height, {}};
  for (const float value : values) {
    for (const float c : color_of(value)) image.rgb.push_back(c);
  }
  return image;
}

Image subtract(const Image& a, const Image& b) {
  Image difference = a;
  difference.layers.clear();
  for (std::size_t i = 0; i < a.rgb.size(); ++i) difference.rgb[i] -= b.rgb[i];
  return difference;
}

void write_difference(const std::string& path, const Image& a, const Image& b,
                      std::span<const float> flip) {
  const bool is_linear = image_ending(path) == ".exr";
  write_image(path, is_linear ? subtract(a, b) : false_colors(flip, a.width, a.height), {});
}

}  // namespace pt
