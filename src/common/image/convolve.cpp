#include "common/image/convolve.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace pt {
namespace {

/// Along one axis: `count` values, `stride` apart.
void convolve_line(const float* from, float* to, int count, std::ptrdiff_t stride,
                   std::span<const float> kernel) {
  const int radius = static_cast<int>(kernel.size() / 2);
  for (int i = 0; i < count; ++i) {
    float sum = 0;
    for (int k = -radius; k <= radius; ++k) {
      sum += kernel[static_cast<std::size_t>(k + radius)] *
             from[std::clamp(i + k, 0, count - 1) * stride];
    }
    to[i * stride] = sum;
  }
}

}  // namespace

ImagePlane convolve(const ImagePlane& image, std::span<const float> x, std::span<const float> y) {
  ImagePlane rows(image.width, image.height), result = rows;
  tbb::parallel_for(0, image.height, [&](int row) {
    const std::ptrdiff_t first = std::ptrdiff_t{row} * image.width;
    convolve_line(&image.values[first], &rows.values[first], image.width, 1, x);
  });
  tbb::parallel_for(0, image.width, [&](int column) {
    convolve_line(&rows.values[column], &result.values[column], image.height, image.width, y);
  });
  return result;
}

}  // namespace pt
