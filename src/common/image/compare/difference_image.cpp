#include "common/image/compare/difference_image.h"

#include <algorithm>
#include <array>

#include "common/image/codecs/image_io.h"
#include "common/image/tone_mapping.h"

namespace pt {
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
