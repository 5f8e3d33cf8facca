#include "common/image/compare/convolve.h"

#include <algorithm>
#include <vector>

namespace pt {
namespace {

/// Adds `count` weighted values. Each sum adds its terms in the kernel's order, whoever calls this
/// for how many at a time: so vectors of processors change no bit.
void add_weighted(const float* from, float weight, float* to, int count) {
  for (int i = 0; i < count; ++i) to[i] += weight * from[i];
}

/// A row with its first and last value repeated on both sides.
std::vector<float> padded(const float* row, int width, int radius) {
  std::vector<float> result(static_cast<std::size_t>(width + 2 * radius));
  for (int i = 0; i < width + 2 * radius; ++i) {
    result[static_cast<std::size_t>(i)] = row[std::clamp(i - radius, 0, width - 1)];
  }
  return result;
}

}  // namespace

ImagePlane convolve(const ImagePlane& image, std::span<const float> x, std::span<const float> y) {
  ImagePlane rows(image.width, image.height), result = rows;
  const auto row_of = [&](auto& plane, int row) {
    return plane.values.data() + std::ptrdiff_t{row} * image.width;
  };
  for (int row = 0; row < image.height; ++row) {
    const int radius = static_cast<int>(x.size() / 2);
    const std::vector<float> from = padded(row_of(image, row), image.width, radius);
    for (std::size_t k = 0; k < x.size(); ++k) {
      add_weighted(&from[k], x[k], row_of(rows, row), image.width);
    }
  }
  for (int row = 0; row < image.height; ++row) {
    const int radius = static_cast<int>(y.size() / 2);
    for (int k = -radius; k <= radius; ++k) {
      const int from = std::clamp(row + k, 0, image.height - 1);
      add_weighted(row_of(rows, from), y[static_cast<std::size_t>(k + radius)], row_of(result, row),
                   image.width);
    }
  }
  return result;
}

}  // namespace pt
