// How far two images are apart, and where, as a picture.
#pragma once

#include <cstdint>
#include <span>
#include <string>

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

/// Values in [0, 1] as colours from black over violet, red and orange to a pale yellow, brighter
/// with each step, for a display (linear).
Image false_colors(std::span<const float> values, int width, int height);

/// `a` - `b`, value by value.
Image subtract(const Image& a, const Image& b);

/// Writes how `a` differs from the reference `b`: into an .exr a - b, into other formats the FLIP
/// of each pixel, which is given, in false colours. Throws Error.
void write_difference(const std::string& path, const Image& a, const Image& b,
                      std::span<const float> flip);

}  // namespace pt
