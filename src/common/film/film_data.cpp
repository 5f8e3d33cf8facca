#include "common/film/film_data.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/error.h"

namespace pt {
namespace {

std::string text(const Window& w) {
  return fmt::format("{}x{} at {},{}", w.width, w.height, w.x, w.y);
}

void check_merge(const Film& film, const Film& part) {
  if (!film.is_empty() &&
      (film.first_sample != part.first_sample || film.next_sample != part.next_sample)) {
    throw Error(
        fmt::format("a film of the samples {} to {} and one of {} to {}: expected the same "
                    "samples of other pixels; more samples come from continuing a film",
                    film.first_sample, film.next_sample, part.first_sample, part.next_sample));
  }
  for (const Window& window : part.parts) {
    if (!film.window.contains(window)) {
      throw Error(fmt::format("a film of the pixels {}: expected pixels of the film {}",
                              text(window), text(film.window)));
    }
    for (const Window& own : film.parts) {
      if (!own.overlaps(window)) continue;
      throw Error(fmt::format("a film of the pixels {}: the film has samples of {}", text(window),
                              text(own)));
    }
  }
}

/// The pixel in the film's own order.
std::uint64_t place_of(const Film& film, std::uint32_t x, std::uint32_t y) {
  return std::uint64_t{y - film.window.y} * film.window.width + (x - film.window.x);
}

}  // namespace

bool Film::is_complete() const {
  std::uint64_t pixel_count = 0;
  for (const Window& part : parts) pixel_count += part.pixel_count();
  return pixel_count == window.pixel_count();
}

Film blank_film(int width, int height) {
  Film film;
  film.window = {0, 0, static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
  return film;
}

void merge(Film& film, const Film& part) {
  if (part.is_empty()) return;
  check_merge(film, part);
  film.first_sample = part.first_sample;
  film.next_sample = part.next_sample;
  film.pixels.resize(film.window.pixel_count());
  for (const Window& w : part.parts) {
    for (std::uint32_t y = w.y; y < w.y + w.height; ++y) {
      const FilmPixel* row = &part.pixels[place_of(part, w.x, y)];
      std::copy(row, row + w.width, &film.pixels[place_of(film, w.x, y)]);
    }
    film.parts.push_back(w);
  }
  film.tally = film.tally + part.tally;
  if (film.is_complete()) film.parts = {film.window};
}

PathTally operator+(PathTally a, const PathTally& b) {
  a.rays += b.rays;
  a.shadow_rays += b.shadow_rays;
  a.nonfinite += b.nonfinite;
  for (int i = 0; i < path_length_bins; ++i) a.lengths[i] += b.lengths[i];
  return a;
}

}  // namespace pt
