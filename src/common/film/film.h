// From samples to pixels, in an order that no schedule can change: each sample's radiance has its
// own place in the batch's sample buffer, and a pixel adds its samples one after the other.
#pragma once

#include "common/math/fast_divide.h"
#include "common/sampling/random.h"
#include "common/transport/path.h"

namespace pt {

/// One finished path.
struct alignas(16) Sample {
  Color radiance = Color(0.0f);
  std::uint32_t rays = 0;  ///< closest-hit rays, shadow rays << 16
};

/// The samples of one batch: [sample in the batch][y][x]. A path's number is its place here.
struct SampleBuffer {
  Sample* samples = nullptr;
  FastDivider width;
  FastDivider pixel_count;
  std::uint32_t first_sample = 0;  ///< of the batch, counted from the image's first
  std::uint32_t path_count = 0;    ///< samples in the batch * pixels, below 2^31

  /// The state of a new path: the one with this number.
  PT_HD PathState begin_path(std::uint32_t number) const {
    PathState path;
    path.sample = pixel_count.quotient(number);
    const std::uint32_t pixel = number - path.sample * pixel_count.divisor();
    const std::uint32_t y = width.quotient(pixel);
    path.pixel = pack_pixel(pixel - y * width.divisor(), y);
    return path;
  }

  PT_HD std::uint32_t number_of(const PathState& path) const {
    return path.sample * pixel_count.divisor() + pixel_y(path.pixel) * width.divisor() +
           pixel_x(path.pixel);
  }

  PT_HD PathId id_of(const PathState& path) const {
    return {path.pixel, first_sample + path.sample, number_of(path)};
  }

  PT_HD void store(const PathState& path, const Color& radiance) const {
    store_wide(&samples[number_of(path)],
               Sample{radiance, path.rays | std::uint32_t{path.shadow_rays} << 16});
  }
};

/// The sum of a pixel's finite samples.
struct FilmPixel {
  double sum[3] = {0, 0, 0};
  std::uint64_t samples = 0;
};

inline constexpr int path_length_bins = 128;  ///< the last one also counts all longer paths

/// What the samples say of the work that was done.
struct PathTally {
  std::uint64_t rays = 0;
  std::uint64_t shadow_rays = 0;
  std::uint64_t nonfinite = 0;
  std::uint64_t lengths[path_length_bins] = {};  ///< [k]: paths of k + 1 rays
};

PT_HD bool is_finite(const Color& c) {
  constexpr float largest = 3.4028235e38f;
  return fabsf(c.x) <= largest && fabsf(c.y) <= largest && fabsf(c.z) <= largest;
}

PT_HD int length_bin(std::uint32_t rays) {
  return rays == 0                 ? 0
         : rays < path_length_bins ? static_cast<int>(rays) - 1
                                   : path_length_bins - 1;
}

/// Adds one pixel's samples of the batch to the film, in their order; `count(bin)` is called with
/// the length bin of each path, and `tally` gets the other numbers.
template <class CountLength>
PT_HD void accumulate_pixel(FilmPixel* film, const SampleBuffer& buffer, std::uint32_t pixel,
                            PathTally& tally, CountLength&& count) {
  FilmPixel sum = film[pixel];
  const std::uint32_t stride = buffer.pixel_count.divisor();
  for (std::uint32_t i = pixel; i < buffer.path_count; i += stride) {
    const Sample sample = load_wide(&buffer.samples[i]);
    tally.rays += sample.rays & 0xffffu;
    tally.shadow_rays += sample.rays >> 16;
    count(length_bin(sample.rays & 0xffffu));
    if (is_finite(sample.radiance)) {
      for (int c = 0; c < 3; ++c) sum.sum[c] += sample.radiance[c];
      ++sum.samples;
    } else {
      ++tally.nonfinite;
    }
  }
  film[pixel] = sum;
}

}  // namespace pt
