#include "common/image/measure_exposure.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pt {
namespace {

constexpr double middle_grey = 0.18;
constexpr double bright_share = 0.01;
constexpr float display_range = 1000.0f;

/// Of the pixels that are not black, ascending.
std::vector<float> luminances(const Image& image) {
  std::vector<float> values;
  for (std::size_t i = 0; i + 2 < image.rgb.size(); i += 3) {
    const float* p = image.rgb.data() + i;
    const float y = 0.2126f * p[0] + 0.7152f * p[1] + 0.0722f * p[2];
    if (y > 0.0f && std::isfinite(y)) values.push_back(y);
  }
  std::ranges::sort(values);
  return values;
}

}  // namespace

float measure_exposure(const Image& image) {
  const std::vector<float> values = luminances(image);
  if (values.empty()) return 0.0f;
  const auto dropped = static_cast<std::size_t>(bright_share * static_cast<double>(values.size()));
  const auto end = values.end() - static_cast<std::ptrdiff_t>(dropped);
  const auto begin = std::lower_bound(values.begin(), end, end[-1] / display_range);
  double sum = 0;
  for (auto value = begin; value != end; ++value) sum += std::log2(static_cast<double>(*value));
  const double stops = std::log2(middle_grey) - sum / static_cast<double>(end - begin);
  return static_cast<float>(std::clamp(stops, -100.0, 100.0));
}

}  // namespace pt
