// An image in memory: linear RGB, row by row from the top.
#pragma once

#include <vector>

namespace pt {

struct Image {
  int width = 0;
  int height = 0;
  std::vector<float> rgb;  ///< 3 * width * height linear radiance values

  float* pixel(int x, int y) { return rgb.data() + 3 * (static_cast<std::size_t>(y) * width + x); }
  const float* pixel(int x, int y) const {
    return rgb.data() + 3 * (static_cast<std::size_t>(y) * width + x);
  }
};

}  // namespace pt
