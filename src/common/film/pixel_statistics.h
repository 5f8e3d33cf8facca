// A pixel's value, and an estimate of its error, from its sums.
#pragma once

#include <array>
#include <cstdint>

#include "common/film/film_data.h"

namespace pt {

/// The weights of the mean of the positive and the mean of the negative samples of a pixel
/// (PixelFilter). Each mean is without bias whatever the number of its samples, and so is the
/// pixel; but where one sign has no sample the other stands alone, which with few samples blurs
/// the filter. A constant stays a constant.
std::array<double, 2> sign_weights(const PixelFilter& filter, std::uint64_t positive,
                                   std::uint64_t negative);

/// Reads a film's sums pixel by pixel.
class PixelReader {
 public:
  /// Reads `pixel_count` pixels; `sums` may be larger than that.
  PixelReader(const FilmSums& sums, const FilmPlan& plan, const PixelFilter& filter,
              std::uint64_t pixel_count)
      : sums_(sums), plan_(plan), filter_(filter), count_(pixel_count) {}

  /// Radiance, W / (m^2 sr); black where there is no sample.
  std::array<double, 3> value(std::uint64_t pixel) const;
  /// `samples`: of each pixel, the non-finite ones included. The variance of the pixel's luminance
  /// is that of a mean, s^2 / n with s^2 = (sum y^2 - (sum y)^2 / n) / (n - 1), added up over the
  /// signs with their weights squared; 0 where there are fewer than two samples.
  PixelStatistics statistics(std::uint64_t pixel, std::uint64_t samples) const;
  /// The mean of a plane of features (1: the first channel), as `value` is that of radiance.
  double feature(std::uint64_t pixel, std::uint32_t plane) const;
  /// An AOV that is an index: that of the pixel's first sample.
  std::uint32_t number(std::uint64_t pixel, std::uint32_t plane) const;

 private:
  double plane_value(std::uint64_t pixel, std::uint32_t sign, std::uint32_t plane) const;

  const FilmSums& sums_;
  const FilmPlan& plan_;
  const PixelFilter& filter_;
  std::uint64_t count_;
};

/// The relative standard error of an image: the root of its pixels' mean variance by their mean
/// luminance, which estimates RMSE / mean. It is what --target-error goes by. To stop by it is
/// sequential estimation (Chow and Robbins, On the Asymptotic Theory of Fixed-Width Sequential
/// Confidence Intervals for the Mean, 1965): right for many samples, while with few it may stop
/// early, since what no sample has found yet has no variance.
double relative_error(const PixelReader& reader, std::uint64_t pixel_count, std::uint64_t samples);

}  // namespace pt
