// What a film sums besides radiance: moments for statistics, the features of first hits, and a
// second set of all sums for the samples of a filter's negative parts. A film without AOVs, with a
// filter that has none, does not come here.
#pragma once

#include "common/film/aov.h"
#include "common/film/film.h"

namespace pt {

/// Which sums a film has. All films of an image have the same.
struct FilmPlan {
  std::uint32_t aovs = 0;
  bool moments = false;
  bool two_signs = false;

  bool operator==(const FilmPlan&) const = default;
  PT_HD std::uint32_t signs() const { return two_signs ? 2 : 1; }
  bool is_radiance_alone() const { return !moments && !two_signs; }
  /// Planes of doubles for each sign: how many samples, then a plane for each channel.
  std::uint32_t feature_planes() const {
    const std::uint32_t planes = feature_plane_count(aovs);
    return planes == 0 ? 0 : planes + 1;
  }
  std::uint64_t bytes_per_pixel() const {
    return signs() * (sizeof(FilmPixel) + (moments ? sizeof(PixelMoments) : 0) +
                      sizeof(double) * feature_planes());
  }
};

/// The sums of a film in a device's memory: a view. Each array is [sign][pixel of the window], the
/// features [sign][plane][pixel].
struct FilmView {
  FilmPixel* pixels = nullptr;
  PixelMoments* moments = nullptr;  ///< null: not asked for
  double* features = nullptr;       ///< null: not asked for
  std::uint32_t aovs = 0;
  std::uint32_t planes = 0;  ///< FilmPlan::feature_planes()
  bool two_signs = false;
  std::uint32_t first_sample = 0;  ///< of the film
};

/// A pixel's sums of all kinds but features (see RadianceSum). The sign of a sample is computed
/// again from its random numbers, so that no path has to carry it.
template <class Source>
class PixelPlanes {
 public:
  PT_HD PixelPlanes(const FilmView& film, const SampleBuffer& buffer, const PixelFilter& filter,
                    const Source& source, std::uint32_t pixel)
      : film_(film), filter_(filter), source_(source), id_(buffer.id_of(pixel)), pixel_(pixel) {
    pixel_count_ = buffer.pixel_count.divisor();
  }

  PT_HD void add(const Sample& sample, std::uint32_t sample_index, bool is_finite) const {
    const std::uint32_t index = pixel_ + (is_negative(sample_index) ? pixel_count_ : 0);
    if (is_finite) {
      FilmPixel& sum = film_.pixels[index];
      for (int c = 0; c < 3; ++c) sum.sum[c] += sample.radiance[c];
      ++sum.samples;
    }
    if (film_.moments == nullptr) return;
    PixelMoments& moments = film_.moments[index];
    if (is_finite) {
      const double y = luminance(sample.radiance);
      moments.luminance_squares += y * y;
    }
    moments.rays += sample.rays & 0xffffu;
    moments.shadow_rays += sample.rays >> 16;
  }
  PT_HD void store() const {}

 private:
  PT_HD bool is_negative(std::uint32_t sample_index) const {
    if (!film_.two_signs) return false;
    auto random = source_.open({id_.pixel, id_.sample + sample_index, 0});
    const Vec4 u = random.draw(scatter_block(0));
    return filter_.is_negative(u.x, u.y);
  }

  const FilmView& film_;
  const PixelFilter& filter_;
  const Source& source_;
  PathId id_;
  std::uint32_t pixel_, pixel_count_;
};

/// Adds the values of one AOV to its planes.
template <class Aov>
PT_HD void add_feature(const FirstHit& hit, double* plane, std::size_t stride) {
  const auto value = Aov::of(hit);
  if constexpr (std::is_arithmetic_v<std::remove_cv_t<decltype(value)>>) {
    *plane += value;
  } else {
    for (int c = 0; c < value.length(); ++c) plane[c * stride] += value[c];
  }
}

/// Adds the first hits of a pixel's samples of the batch, in their order. Of a film with two signs
/// the numbers of the first sample stand with the positive ones.
template <class Traits, class Source>
PT_HD void accumulate_features(const FilmView& film, const SampleBuffer& buffer, const Scene& scene,
                               const Source& source, std::uint32_t pixel) {
  const std::uint32_t stride = buffer.pixel_count.divisor();
  PathId id = buffer.id_of(pixel);
  for (std::uint32_t k = 0; k < buffer.sample_count; ++k, ++id.sample) {
    bool negative = false;
    const FirstHit hit = first_hit_of_path<Traits>(scene, source, id, negative);
    double* positive = film.features + pixel;
    double* plane = positive + (negative ? std::size_t{film.planes} * stride : 0);
    *plane += 1.0;
    for_each_type(Aovs{}, [&](auto type) {
      using Aov = typename decltype(type)::type;
      if constexpr (aov_source<Aov> != AovSource::statistics) {
        if ((film.aovs & aov_bit<Aov>) == 0) return;
        constexpr bool is_number = aov_source<Aov> == AovSource::number;
        constexpr std::size_t channels = aov_table[index_in<Aov>(Aovs{})].channels.size();
        plane += stride, positive += stride;
        if (!is_number) {
          add_feature<Aov>(hit, plane, stride);
        } else if (id.sample == film.first_sample) {
          add_feature<Aov>(hit, positive, stride);
        }
        plane += (channels - 1) * stride, positive += (channels - 1) * stride;
      }
    });
  }
}

}  // namespace pt
