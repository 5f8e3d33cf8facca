// Separable convolution of one channel of an image, whose border goes on for ever.
#pragma once

#include <span>
#include <vector>

namespace pt {

struct ImagePlane {
  int width = 0, height = 0;
  std::vector<float> values;  ///< [y][x]

  ImagePlane() = default;
  ImagePlane(int w, int h)
      : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
};

/// Each value becomes the sum over (i, j) of x[i] y[j] times the value (i, j) to the right and
/// down of it, i and j counted from the middles of the kernels, which have odd sizes.
ImagePlane convolve(const ImagePlane& image, std::span<const float> x, std::span<const float> y);

}  // namespace pt
