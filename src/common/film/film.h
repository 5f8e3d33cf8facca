// From samples to pixels, in an order that no mode can change: each sample's radiance has its
// own element of the batch's sample buffer, and a pixel adds its samples one after the other.
#pragma once

#include "common/math/functions.h"
#include "common/sampling/random.h"
#include "common/transport/path.h"

namespace pt {

/// One finished path.
struct alignas(16) Sample {
  Color radiance = Color(0.0f);  ///< W / (m^2 sr)
  std::uint32_t rays = 0;        ///< closest-hit rays, shadow rays << 16
};

/// A rectangle of an image's pixels.
struct Window {
  std::uint32_t x = 0, y = 0;  ///< the first column and row
  std::uint32_t width = 0, height = 0;

  bool operator==(const Window&) const = default;
  std::uint64_t pixel_count() const { return std::uint64_t{width} * height; }
  bool contains(const Window& w) const {
    return w.x >= x && w.y >= y && end(w.x, w.width) <= end(x, width) &&
           end(w.y, w.height) <= end(y, height);
  }
  bool overlaps(const Window& w) const {
    return w.x < end(x, width) && x < end(w.x, w.width) && w.y < end(y, height) &&
           y < end(w.y, w.height);
  }

 private:
  static std::uint64_t end(std::uint32_t first, std::uint32_t count) {
    return std::uint64_t{first} + count;
  }
};

/// The samples of one batch: [sample in the batch][y][x] of a window's pixels. A path's index is
/// that of its sample here; its PathId and so its random numbers are the image's, whatever the
/// window.
struct SampleBuffer {
  Sample* samples = nullptr;
  FastDivider width;  ///< of the window
  FastDivider pixel_count;
  std::uint32_t corner = 0;        ///< the window's first pixel: x | y << 16
  std::uint32_t first_sample = 0;  ///< of the batch, counted from the image's first
  std::uint32_t sample_count = 0;  ///< in the batch
  std::uint32_t path_count = 0;    ///< sample_count * pixels, below 2^31

  SampleBuffer() = default;
  /// The samples [first, first + count) of a window's pixels.
  SampleBuffer(Sample* memory, const Window& window, std::uint32_t first, std::uint32_t count)
      : samples(memory),
        width(window.width),
        pixel_count(window.width * window.height),
        corner(pack_pixel(window.x, window.y)),
        first_sample(first),
        sample_count(count),
        path_count(window.width * window.height * count) {}
  bool operator==(const SampleBuffer&) const = default;

  PT_HD std::uint32_t height() const { return pixel_count.divisor() / width.divisor(); }

  PT_HD PathId id_of(std::uint32_t path_index) const {
    const std::uint32_t sample = pixel_count.quotient(path_index);
    const std::uint32_t pixel = path_index - sample * pixel_count.divisor();
    const std::uint32_t y = width.quotient(pixel);
    return {corner + pack_pixel(pixel - y * width.divisor(), y), first_sample + sample, path_index};
  }

  /// The index of the path of a sample of the batch at pixel (x, y) of the window.
  PT_HD std::uint32_t index_of(std::uint32_t x, std::uint32_t y, std::uint32_t sample) const {
    return sample * pixel_count.divisor() + y * width.divisor() + x;
  }

  /// The end of every path, in all modes.
  PT_HD void store(const PathState& path, const Color& radiance) const {
    store_wide(&samples[path.index], Sample{radiance, path.packed_rays()});
  }
};

/// The sum of a pixel's finite samples.
struct FilmPixel {
  double sum[3] = {0, 0, 0};
  std::uint64_t samples = 0;

  /// The factor from a sum to the mean; 0 without samples.
  PT_HD double to_mean() const { return samples == 0 ? 0.0 : 1.0 / static_cast<double>(samples); }
};

inline constexpr int path_length_bins = 128;  ///< the last one also counts all longer paths

/// Counts of the work that the samples took.
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

/// Counts a finished path, its length by count(bin); returns whether its radiance is finite.
template <class Count>
PT_HD bool count_sample(const Sample& sample, PathTally& tally, Count&& count) {
  const bool finite = is_finite(sample.radiance);
  tally.rays += sample.rays & 0xffffu;
  tally.shadow_rays += sample.rays >> 16;
  if (!finite) ++tally.nonfinite;
  count(length_bin(sample.rays & 0xffffu));
  return finite;
}

/// The sums of a pixel beyond its radiance, where an option needs them.
struct PixelMoments {
  double luminance_squares = 0;  ///< of the finite samples
  std::uint64_t rays = 0;        ///< of all samples, as are the shadow rays
  std::uint64_t shadow_rays = 0;
};

/// A pixel's sum of radiance alone: what accumulate_pixel adds samples to. PixelPlanes
/// (film_planes.h) is the other kind of sum.
class RadianceSum {
 public:
  PT_HD RadianceSum(FilmPixel* film, std::uint32_t pixel) : stored_(film + pixel), sum_(*stored_) {}

  /// `sample_index` counts the samples of the batch; `is_finite` is what the tally says of it.
  PT_HD void add(const Sample& sample, std::uint32_t /*sample_index*/, bool is_finite) {
    if (!is_finite) return;
    for (int c = 0; c < 3; ++c) sum_.sum[c] += sample.radiance[c];
    ++sum_.samples;
  }
  PT_HD void store() const { *stored_ = sum_; }

 private:
  FilmPixel* stored_;
  FilmPixel sum_;
};

/// Adds one pixel's samples of the batch to its sum, in their order; `count(bin)` is called with
/// the length bin of each path, and `tally` gets the other numbers. Several samples are loaded
/// before the first is used, since nothing else hides the latency of a thread that walks through a
/// batch.
template <class Sum, class CountLength>
PT_HD void accumulate_pixel(Sum sum, const SampleBuffer& buffer, std::uint32_t pixel,
                            PathTally& tally, CountLength&& count) {
  constexpr std::uint32_t ahead = 8;
  const std::uint32_t stride = buffer.pixel_count.divisor();
  const std::uint32_t sample_count = buffer.sample_count;
  for (std::uint32_t first = 0; first < sample_count; first += ahead) {
    Sample loaded[ahead];
    PT_UNROLL(8)
    for (std::uint32_t k = 0; k < ahead; ++k) {
      if (first + k < sample_count) {
        loaded[k] = load_wide(&buffer.samples[(first + k) * stride + pixel]);
      }
    }
    PT_UNROLL(8)
    for (std::uint32_t k = 0; k < ahead; ++k) {
      if (first + k >= sample_count) break;
      const bool finite = count_sample(loaded[k], tally, count);
      sum.add(loaded[k], first + k, finite);
    }
  }
  sum.store();
}

/// The sink (transport/path_step.h) of a path that is about to end: puts its radiance into its
/// sample.
struct PathSample {
  const SampleBuffer& samples;
  Color radiance;  ///< of the path so far

  PT_HD void emit(const PathState&, const Color& emitted) { radiance += emitted; }
  PT_HD void end(const PathState& path) { samples.store(path, radiance); }
};

}  // namespace pt
