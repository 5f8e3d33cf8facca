#include "common/film/film_data.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/error/error.h"

namespace pt {
namespace {

void check_merge(const Film& film, const Film& part) {
  if (!film.is_empty() &&
      (film.first_sample != part.first_sample || film.next_sample != part.next_sample)) {
    throw Error(
        fmt::format("a film of the samples {} to {} and one of {} to {}: expected the same "
                    "samples of other pixels; more samples come from continuing a film",
                    film.first_sample, film.next_sample, part.first_sample, part.next_sample));
  }
  const auto planes_differ = [&](const auto& own, const auto& others) {
    return own.size() * part.window.pixel_count() != others.size() * film.window.pixel_count();
  };
  if (!film.is_empty() &&
      (planes_differ(film.pixels, part.pixels) || planes_differ(film.moments, part.moments) ||
       planes_differ(film.features, part.features))) {
    throw Error("two films of different planes: expected the same --aov and --filter");
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
std::uint64_t index_of(const Film& film, std::uint32_t x, std::uint32_t y) {
  return std::uint64_t{y - film.window.y} * film.window.width + (x - film.window.x);
}

/// Copies the pixels of `w` in each plane; `to` gets as many planes as `from` has.
template <class T>
void copy_planes(const Film& film, std::vector<T>& to, const Film& part, const std::vector<T>& from,
                 const Window& w) {
  const std::uint64_t count = film.window.pixel_count(), part_count = part.window.pixel_count();
  const std::uint64_t planes = from.size() / part_count;
  to.resize(planes * count);
  for (std::uint64_t plane = 0; plane < planes; ++plane) {
    for (std::uint32_t y = w.y; y < w.y + w.height; ++y) {
      const T* row = &from[plane * part_count + index_of(part, w.x, y)];
      std::copy(row, row + w.width, &to[plane * count + index_of(film, w.x, y)]);
    }
  }
}

}  // namespace

std::string text(const Window& w) {
  return fmt::format("{}x{} at {},{}", w.width, w.height, w.x, w.y);
}

void FilmSums::reset(const FilmPlan& plan, std::uint64_t pixel_count) {
  const std::uint64_t count = plan.signs() * pixel_count;
  pixels.assign(count, {});
  moments.assign(plan.moments ? count : 0, {});
  features.assign(count * plan.feature_planes(), 0.0);
}

bool FilmSums::have(const FilmPlan& plan, std::uint64_t pixel_count) const {
  const std::uint64_t count = plan.signs() * pixel_count;
  return pixels.size() == count && moments.size() == (plan.moments ? count : 0) &&
         features.size() == count * plan.feature_planes();
}

bool Film::is_complete() const {
  std::uint64_t pixel_count = 0;
  for (const Window& part : parts) pixel_count += part.pixel_count();
  return pixel_count == window.pixel_count();
}

void merge(Film& film, const Film& part) {
  if (part.is_empty()) return;
  check_merge(film, part);
  film.first_sample = part.first_sample;
  film.next_sample = part.next_sample;
  for (const Window& w : part.parts) {
    copy_planes(film, film.pixels, part, part.pixels, w);
    copy_planes(film, film.moments, part, part.moments, w);
    copy_planes(film, film.features, part, part.features, w);
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
