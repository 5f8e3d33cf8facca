// How far two images are apart.
#pragma once

#include <cstdint>

#include "common/image/image.h"

namespace pt {

struct ImageDifference {
  double rmse = 0;          ///< sqrt(mean over values of (a - b)^2)
  double relative_mse = 0;  ///< mean of (a - b)^2 / (b^2 + 1e-2), b the reference (Rousselle 2011)
  double largest = 0;       ///< largest |a - b|; infinite where one value is not finite and the
                            ///< two differ in bits
  std::uint64_t differing_pixels = 0;       ///< pixels with any value of different bits
  std::uint64_t pixels_past_tolerance = 0;  ///< pixels with any |a - b| > tolerance
};

/// Throws Error when the sizes differ. `tolerance` >= 0.
ImageDifference compare_images(const Image& a, const Image& b, double tolerance);

}  // namespace pt
