// An image in parts: windows of its pixels, and ranges of its samples, rendered apart.
#pragma once

#include "common/film/develop.h"
#include "mode_cases.h"

namespace pt {

/// Every pixel of an image, without samples.
inline Film blank_film(int width, int height) {
  Film film;
  film.window = {0, 0, static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
  return film;
}

/// Divides an image of `width` x `height` pixels; the parts are neither sorted nor alike.
inline std::vector<std::vector<Window>> divisions(std::uint32_t width, std::uint32_t height) {
  std::vector<Window> columns, rows;
  for (std::uint32_t x = 0; x < width; x += 7)
    columns.push_back({x, 0, std::min(7u, width - x), height});
  for (std::uint32_t y = 0; y < height; ++y) rows.push_back({0, height - 1 - y, width, 1});
  const std::uint32_t x = width / 3, y = height - 2;
  // One pixel, what is left and right of it, what is above and below.
  const std::vector<Window> around_a_pixel{{0, y + 1, width, height - y - 1},
                                           {x, y, 1, 1},
                                           {x + 1, y, width - x - 1, 1},
                                           {0, 0, width, y},
                                           {0, y, x, 1}};
  return {columns, rows, around_a_pixel};
}

/// Renders each window by itself, `step` samples at a time, and merges them.
inline Film render_windows(Renderer& renderer, const Options& options,
                           const std::vector<Window>& windows, int step) {
  Film whole = blank_film(options.width, options.height);
  for (const Window& window : windows) {
    EXPECT_FALSE(whole.is_complete());
    Film part;
    part.window = window;
    for (int done = 0; done < options.spp; done += step) {
      const int samples = std::min(step, options.spp - done);
      EXPECT_EQ(renderer.render(part, samples, {}).samples_done, samples);
    }
    EXPECT_EQ(part.next_sample, static_cast<std::uint32_t>(options.spp));
    if (part.pixels.size() == window.pixel_count()) {  // of one sign
      const Image image =
          develop(part.pixels, static_cast<int>(window.width), static_cast<int>(window.height));
      EXPECT_EQ(differing_pixels(renderer.image(), image), 0u) << "the window's image";
    }
    merge(whole, part);
  }
  EXPECT_TRUE(whole.is_complete());
  return whole;
}

/// Pixels of which any bit differs: not only their means.
inline std::size_t differing_sums(const Film& a, const Film& b) {
  if (!(a.window == b.window) || a.pixels.size() != b.pixels.size()) return ~std::size_t{0};
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    count += std::memcmp(&a.pixels[i], &b.pixels[i], sizeof(FilmPixel)) != 0;
  }
  if (a.moments.size() != b.moments.size() || a.features.size() != b.features.size()) {
    return ~std::size_t{0};
  }
  for (std::size_t i = 0; i < a.moments.size(); ++i) {
    count += std::memcmp(&a.moments[i], &b.moments[i], sizeof(PixelMoments)) != 0;
  }
  for (std::size_t i = 0; i < a.features.size(); ++i) count += a.features[i] != b.features[i];
  return count;
}

inline void expect_film(const Film& film, const Rendered& expected) {
  if (film.pixels.size() == film.window.pixel_count()) {  // of one sign
    const Image image = develop(film.pixels, expected.image.width, expected.image.height);
    EXPECT_EQ(differing_pixels(image, expected.image), 0u) << "pixels differ";
  }
  expect_same_counts(summarize(film.tally), expected.counts);
}

/// What the renderer says of the film that it has just rendered.
inline Rendered last_image(Renderer& renderer) {
  RenderReport report;
  renderer.describe(report);
  return {renderer.image(), report.counts, {}};
}

/// An image in windows and in steps equals the one that `reference` renders at once.
inline void expect_parts_make_the_whole(const Options& options, const Options& reference) {
  const Rendered expected = render_options(reference);
  expect_plausible(expected, reference);
  const DeviceInfo device = choose_device(options.device);
  const SceneData scene = make_scene_for(options, device);
  const auto renderer = make_renderer(options, scene, device);
  const auto width = static_cast<std::uint32_t>(options.width);
  const auto height = static_cast<std::uint32_t>(options.height);
  Film whole = blank_film(options.width, options.height);
  renderer->render(whole, options.spp, {});
  expect_film(whole, expected);
  int step = options.spp;
  for (const std::vector<Window>& windows : divisions(width, height)) {
    SCOPED_TRACE(testing::Message()
                 << command_of(options) << ", " << windows.size() << " windows, steps of " << step);
    const Film film = render_windows(*renderer, options, windows, step);
    expect_film(film, expected);
    EXPECT_EQ(differing_sums(film, whole), 0u);
    step = std::max(1, step / 2);
  }
  expect_same(take_image(*renderer), expected);  // a window leaves nothing behind
}

}  // namespace pt
