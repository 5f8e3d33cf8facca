// Where two images differ, as a picture.
#pragma once

#include <span>
#include <string>

#include "common/image/image.h"

namespace pt {

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
