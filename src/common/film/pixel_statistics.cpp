#include "common/film/pixel_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pt {
namespace {

double luminance_of(const double* c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }

/// The number that a plane has, or 0 where a damaged file left something else there.
template <class Integer>
Integer integer_of(double value) {
  const double end = std::ldexp(1.0, std::numeric_limits<Integer>::digits);
  return value >= 0 && value < end ? static_cast<Integer>(value) : 0;
}

}  // namespace

std::array<double, 2> sign_weights(const PixelFilter& filter, std::uint64_t positive,
                                   std::uint64_t negative) {
  if (negative == 0) return {1.0, 0.0};
  if (positive == 0) return {0.0, 1.0};
  return {filter.positive_weight, -double{filter.negative_weight}};
}

std::array<double, 3> PixelReader::value(std::uint64_t pixel) const {
  const FilmPixel& positive = sums_.pixels[pixel];
  const double to_mean = positive.to_mean();
  std::array<double, 3> value{};
  for (std::size_t c = 0; c < 3; ++c) value[c] = positive.sum[c] * to_mean;
  if (!plan_.two_signs) return value;
  const FilmPixel& negative = sums_.pixels[count_ + pixel];
  const auto weights = sign_weights(filter_, positive.samples, negative.samples);
  for (std::size_t c = 0; c < 3; ++c) {
    value[c] = weights[0] * value[c] + weights[1] * (negative.sum[c] * negative.to_mean());
  }
  return value;
}

PixelStatistics PixelReader::statistics(std::uint64_t pixel, std::uint64_t samples) const {
  PixelStatistics result;
  std::uint64_t counts[2] = {};
  for (std::uint32_t s = 0; s < plan_.signs(); ++s) {
    counts[s] = sums_.pixels[s * count_ + pixel].samples;
  }
  const auto weights = sign_weights(filter_, counts[0], counts[1]);
  double rays = 0;
  for (std::uint32_t s = 0; s < plan_.signs(); ++s) {
    const PixelMoments& moments = sums_.moments[s * count_ + pixel];
    const auto n = static_cast<double>(counts[s]);
    const double y = luminance_of(sums_.pixels[s * count_ + pixel].sum);
    if (counts[s] > 1) {
      const double squares = std::max(moments.luminance_squares - y * y / n, 0.0);
      result.variance += weights[s] * weights[s] * squares / ((n - 1) * n);
    }
    result.samples += n;
    rays += static_cast<double>(moments.rays);
    result.rays += static_cast<double>(moments.rays + moments.shadow_rays);
  }
  if (samples > 0) result.bounces = rays / static_cast<double>(samples) - 1.0;
  return result;
}

double PixelReader::plane_value(std::uint64_t pixel, std::uint32_t sign,
                                std::uint32_t plane) const {
  const std::uint64_t planes = plan_.feature_planes();
  return sums_.features[(sign * planes + plane) * count_ + pixel];
}

double PixelReader::feature(std::uint64_t pixel, std::uint32_t plane) const {
  double n[2] = {}, mean[2] = {};
  for (std::uint32_t s = 0; s < plan_.signs(); ++s) {
    n[s] = plane_value(pixel, s, 0);
    mean[s] = n[s] > 0 ? plane_value(pixel, s, plane) / n[s] : 0.0;
  }
  const auto weights =
      sign_weights(filter_, integer_of<std::uint64_t>(n[0]), integer_of<std::uint64_t>(n[1]));
  return weights[0] * mean[0] + weights[1] * mean[1];
}

std::uint32_t PixelReader::number(std::uint64_t pixel, std::uint32_t plane) const {
  return integer_of<std::uint32_t>(plane_value(pixel, 0, plane));
}

double relative_error(const PixelReader& reader, std::uint64_t pixel_count, std::uint64_t samples) {
  double variance = 0, sum = 0;
  for (std::uint64_t pixel = 0; pixel < pixel_count; ++pixel) {
    const std::array<double, 3> value = reader.value(pixel);
    sum += luminance_of(value.data());
    variance += reader.statistics(pixel, samples).variance;
  }
  if (variance == 0) return 0;
  const auto n = static_cast<double>(pixel_count);
  return std::sqrt(variance / n) / std::abs(sum / n);
}

}  // namespace pt
