#include "common/image/compare/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "common/error/error.h"

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

}  // namespace pt
