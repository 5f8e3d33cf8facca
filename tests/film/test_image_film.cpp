// A film that is made in pieces, against sets of single pixels.
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "common/error/error.h"
#include "common/film/develop.h"
#include "common/film/image_film.h"

namespace pt {
namespace {

using Pixels = std::set<std::pair<std::uint32_t, std::uint32_t>>;

Pixels pixels_of(const std::vector<Window>& windows, bool* disjoint = nullptr) {
  Pixels pixels;
  for (const Window& w : windows) {
    for (std::uint32_t y = w.y; y < w.y + w.height; ++y) {
      for (std::uint32_t x = w.x; x < w.x + w.width; ++x) {
        const bool is_new = pixels.insert({x, y}).second;
        if (disjoint != nullptr && !is_new) *disjoint = false;
      }
    }
  }
  return pixels;
}

std::vector<Window> small_windows() {
  std::vector<Window> windows;
  for (std::uint32_t x = 0; x < 4; ++x) {
    for (std::uint32_t y = 0; y < 4; ++y) {
      for (std::uint32_t w = 1; w <= 4; ++w) {
        for (std::uint32_t h = 1; h <= 4; h += 1 + x % 2) windows.push_back({x, y, w, h});
      }
    }
  }
  return windows;
}

TEST(ImageFilm, WindowsAreSetsOfPixels) {
  const std::vector<Window> windows = small_windows();
  for (const Window& a : windows) {
    for (const Window& b : windows) {
      const Pixels in_a = pixels_of({a}), in_b = pixels_of({b});
      Pixels common, rest;
      for (const auto& pixel : in_a) (in_b.contains(pixel) ? common : rest).insert(pixel);
      EXPECT_EQ(pixels_of({intersect(a, b)}), common);
      bool disjoint = true;
      EXPECT_EQ(pixels_of(subtract(a, b), &disjoint), rest);
      EXPECT_TRUE(disjoint);
    }
  }
}

/// A film of the window whose values tell the pixel and the number of samples.
Film film_of(const FilmPlan& plan, const Window& window, std::uint32_t samples) {
  Film film;
  film.window = window;
  film.reset(plan, window.pixel_count());
  film.parts = {window};
  film.next_sample = samples;
  for (std::uint32_t y = 0; y < window.height; ++y) {
    for (std::uint32_t x = 0; x < window.width; ++x) {
      const std::uint64_t pixel = std::uint64_t{y} * window.width + x;
      const double value = 1000.0 * (window.y + y) + (window.x + x) + 1e6 * samples;
      for (std::uint32_t sign = 0; sign < plan.signs(); ++sign) {
        const std::uint64_t at = sign * window.pixel_count() + pixel;
        film.pixels[at].sum[1] = value + 0.25 * sign;
        film.pixels[at].samples = samples;
        if (plan.moments) film.moments[at].luminance_squares = -value;
        for (std::uint32_t p = 0; p < plan.feature_planes(); ++p) {
          film.features[(sign * plan.feature_planes() + p) * window.pixel_count() + pixel] =
              value + 0.5 * p;
        }
      }
    }
  }
  film.tally.rays = window.pixel_count() * samples;
  return film;
}

void expect_same(const Film& a, const Film& b) {
  ASSERT_EQ(a.pixels.size(), b.pixels.size());
  ASSERT_EQ(a.moments.size(), b.moments.size());
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    EXPECT_EQ(a.pixels[i].sum[1], b.pixels[i].sum[1]) << i;
    EXPECT_EQ(a.pixels[i].samples, b.pixels[i].samples) << i;
  }
  for (std::size_t i = 0; i < a.moments.size(); ++i)
    EXPECT_EQ(a.moments[i].luminance_squares, b.moments[i].luminance_squares);
  EXPECT_EQ(a.features, b.features);
}

// Random films are put over one another; a map of pixels says what is there.
TEST(ImageFilm, IsWhatWasPutLast) {
  for (const FilmPlan plan : {FilmPlan{}, FilmPlan{0x8f, true, true}}) {
    std::mt19937 random(7);
    const Window image{3, 5, 11, 7};
    ImageFilm film(image, plan);
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> expected;
    std::uint64_t rays = 0;
    const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
    for (int step = 0; step < 60; ++step) {
      const std::uint32_t x = below(11), y = below(7);
      const Window w{3 + x, 5 + y, 1 + below(11 - x), 1 + below(7 - y)};
      const std::uint32_t samples = 1 + below(9);
      const Film part = film_of(plan, w, samples);
      film.put(part);
      rays += part.tally.rays;
      for (const auto& pixel : pixels_of({w})) expected[pixel] = samples;
      expect_same(film.take(w), part);
      EXPECT_EQ(film.take(w).tally.rays, 0u);

      bool disjoint = true;
      std::vector<Window> windows;
      std::uint64_t samples_in_all = 0;
      for (const FilmPart& own : film.parts) {
        windows.push_back(own.window);
        for (const auto& pixel : pixels_of({own.window}))
          EXPECT_EQ(own.next_sample, expected.at(pixel));
        expect_same(film.take(own.window), film_of(plan, own.window, own.next_sample));
        samples_in_all += own.samples();
      }
      EXPECT_EQ(pixels_of(windows, &disjoint).size(), expected.size());
      EXPECT_TRUE(disjoint);
      EXPECT_EQ(film.samples(), samples_in_all);

      const std::uint32_t wanted = 1 + below(9);
      Pixels lacking, found;
      for (const auto& pixel : pixels_of({image})) {
        if (!expected.contains(pixel) || expected[pixel] < wanted) lacking.insert(pixel);
      }
      std::uint32_t last = 0;
      for (const FilmPart& part_lacking : film.lacking(image, wanted)) {
        EXPECT_GE(part_lacking.next_sample, last);  // ascending
        last = part_lacking.next_sample;
        for (const auto& pixel : pixels_of({part_lacking.window})) {
          EXPECT_TRUE(found.insert(pixel).second);
          EXPECT_EQ(part_lacking.next_sample, expected.contains(pixel) ? expected[pixel] : 0);
        }
      }
      EXPECT_EQ(found, lacking);
    }
    EXPECT_EQ(film.tally.rays, rays);
  }
}

// Films may begin at a later sample than the first: what they have is the difference.
TEST(ImageFilm, SamplesAreCountedFromTheFirst) {
  const FilmPlan plan{0, true, false};
  ImageFilm film({0, 0, 4, 2}, plan);
  for (const auto& [y, first, next] : {std::tuple{0u, 3u, 8u}, {1u, 6u, 9u}}) {
    Film part = film_of(plan, {0, y, 4, 1}, next);
    part.first_sample = first;
    for (PixelMoments& moments : part.moments) moments.rays = 2 * (next - first);
    film.put(part);
  }
  EXPECT_EQ(film.least_samples(), 3u);
  EXPECT_EQ(film.least_samples({{0, 0, 4, 1}}), 5u);
  EXPECT_EQ(film.samples(), 4u * 5 + 4 * 3);
  EXPECT_EQ(film.take({1, 0, 2, 1}).first_sample, 3u);
  EXPECT_EQ(film.take({0, 1, 4, 1}).first_sample, 6u);
  film.plan.aovs = aov_bit<aov::Bounces>;
  const Image image = develop(film, {});
  ASSERT_EQ(image.layers.size(), 1u);
  EXPECT_EQ(image.layers[0].values, std::vector<float>(8, 1.0f));  // two rays, the camera's first
}

TEST(ImageFilm, RefusesPixelsOfUnlikeSamples) {
  ImageFilm film({0, 0, 8, 8}, {});
  EXPECT_TRUE(film.take({0, 0, 8, 8}).is_empty());
  EXPECT_EQ(film.least_samples(), 0u);
  film.put(film_of({}, {0, 0, 8, 4}, 2));
  EXPECT_THROW(film.take({0, 0, 8, 5}), Error);
  film.put(film_of({}, {0, 4, 8, 4}, 3));
  EXPECT_THROW(film.take({0, 0, 8, 5}), Error);
  EXPECT_EQ(film.least_samples(), 2u);
  EXPECT_EQ(film.least_samples({{0, 5, 2, 2}}), 3u);
  film.put(film_of({}, {0, 0, 8, 4}, 3));
  EXPECT_EQ(film.take({0, 0, 8, 8}).next_sample, 3u);
  EXPECT_THROW(film.take({0, 0, 9, 8}), Error);
  EXPECT_THROW(film.put(film_of({}, {4, 4, 5, 1}, 3)), Error);
  EXPECT_THROW(film.put(film_of({0, true, false}, {0, 0, 1, 1}, 3)), Error);
}

}  // namespace
}  // namespace pt
