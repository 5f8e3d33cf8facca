// Films with any bits in their sums, as checkpoints must keep them.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

#include "common/film/image_film.h"

namespace pt {

inline constexpr std::uint32_t all_aovs = (1u << Aovs::size) - 1;

/// Any bits, but for whole samples; every other row has none.
inline ImageFilm random_film(const Window& window, const FilmPlan& plan, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const double special[] = {0.0, -0.0, 5e-324, -2.2e-308, 1.7e308, 0.1, -1e-30};
  const auto number = [&] {
    const std::uint64_t n = random();
    return n % 4 == 0 ? special[n / 4 % 7] : static_cast<double>(n >> 11) * 0x1p-40;
  };
  ImageFilm film(window, plan);
  for (std::uint32_t y = 0; y < window.height; y += 2) {
    Film part;
    part.window = {window.x, window.y + y, window.width, 1};
    part.reset(plan, window.width);
    part.parts = {part.window};
    part.next_sample = 4 + y;
    for (FilmPixel& pixel : part.pixels) {
      for (double& sum : pixel.sum) sum = number();
      pixel.samples = random() % 3;
    }
    for (PixelMoments& m : part.moments) m = {number(), random(), random() >> 40};
    for (double& feature : part.features) feature = number();
    part.tally.shadow_rays = random() >> 8, part.tally.nonfinite = random() >> 8;
    part.tally.rays = random() >> 8, part.tally.lengths[y % path_length_bins] = random() >> 8;
    film.put(part);
  }
  return film;
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

inline bool is_same(const ImageFilm& a, const ImageFilm& b) {
  return a.window == b.window && a.plan == b.plan && a.parts == b.parts &&
         std::memcmp(&a.tally, &b.tally, sizeof a.tally) == 0 && same_bits(a.pixels, b.pixels) &&
         same_bits(a.moments, b.moments) && same_bits(a.features, b.features);
}

}  // namespace pt
