#include "common/film/image_film.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/error/error.h"

namespace pt {
namespace {

/// Calls copy(first in the image's row, first in the part's row, row's length) for each row of each
/// plane of an array that has `planes` values for a pixel.
template <class Copy>
void for_each_row(const Window& image, const Window& part, std::uint64_t planes, Copy&& copy) {
  for (std::uint64_t plane = 0; plane < planes; ++plane) {
    for (std::uint32_t y = 0; y < part.height; ++y) {
      const std::uint64_t row = part.y - image.y + y;
      copy(plane * image.pixel_count() + row * image.width + (part.x - image.x),
           plane * part.pixel_count() + std::uint64_t{y} * part.width, part.width);
    }
  }
}

/// The lengths of the arrays of a FilmSums, as FilmPlan says.
struct PlaneCounts {
  std::uint64_t pixels, moments, features;

  explicit PlaneCounts(const FilmPlan& plan)
      : pixels(plan.signs()),
        moments(plan.moments ? plan.signs() : 0),
        features(std::uint64_t{plan.signs()} * plan.feature_planes()) {}
};

template <class T>
void copy_out(const Window& image, const std::vector<T>& from, const Window& part,
              std::vector<T>& to, std::uint64_t planes) {
  for_each_row(image, part, planes, [&](std::uint64_t own, std::uint64_t others, std::uint32_t n) {
    std::copy_n(from.data() + own, n, to.data() + others);
  });
}

template <class T>
void copy_in(const Window& image, std::vector<T>& to, const Window& part,
             const std::vector<T>& from, std::uint64_t planes) {
  for_each_row(image, part, planes, [&](std::uint64_t own, std::uint64_t others, std::uint32_t n) {
    std::copy_n(from.data() + others, n, to.data() + own);
  });
}

}  // namespace

Window intersect(const Window& a, const Window& b) {
  const std::uint32_t x0 = std::max(a.x, b.x), y0 = std::max(a.y, b.y);
  const std::uint64_t x1 = std::min(std::uint64_t{a.x} + a.width, std::uint64_t{b.x} + b.width);
  const std::uint64_t y1 = std::min(std::uint64_t{a.y} + a.height, std::uint64_t{b.y} + b.height);
  if (x1 <= x0 || y1 <= y0) return {};
  return {x0, y0, static_cast<std::uint32_t>(x1 - x0), static_cast<std::uint32_t>(y1 - y0)};
}

std::vector<Window> subtract(const Window& a, const Window& b) {
  const Window both = intersect(a, b);
  if (both.pixel_count() == 0) return {a};
  const std::uint32_t a_right = a.x + a.width, right = both.x + both.width;
  const std::uint32_t a_bottom = a.y + a.height, bottom = both.y + both.height;
  std::vector<Window> rest{{a.x, a.y, a.width, both.y - a.y},
                           {a.x, both.y, both.x - a.x, both.height},
                           {right, both.y, a_right - right, both.height},
                           {a.x, bottom, a.width, a_bottom - bottom}};
  std::erase_if(rest, [](const Window& w) { return w.pixel_count() == 0; });
  return rest;
}

ImageFilm::ImageFilm(const Window& w, const FilmPlan& p) : window(w), plan(p) {
  reset(plan, window.pixel_count());
}

Film ImageFilm::take(const Window& part, FilmSums&& memory) const {
  if (part.pixel_count() == 0 || !window.contains(part)) {
    throw Error(fmt::format("a film of the pixels {}: expected pixels of the image {}", text(part),
                            text(window)));
  }
  Film film;
  static_cast<FilmSums&>(film) = std::move(memory);
  film.window = part;
  std::uint64_t covered = 0;
  for (const FilmPart& own : parts) {
    const std::uint64_t common = intersect(own.window, part).pixel_count();
    if (common == 0) continue;
    if (covered > 0 &&
        (film.first_sample != own.first_sample || film.next_sample != own.next_sample)) {
      throw Error(fmt::format("the pixels {}: expected all to have the same samples", text(part)));
    }
    covered += common;
    film.first_sample = own.first_sample, film.next_sample = own.next_sample;
  }
  if (covered == 0) return film;
  if (covered != part.pixel_count()) {
    throw Error(fmt::format("the pixels {}: expected all or none to have samples", text(part)));
  }
  film.reset(plan, part.pixel_count());
  film.parts = {part};
  const PlaneCounts planes(plan);
  copy_out(window, pixels, part, film.pixels, planes.pixels);
  copy_out(window, moments, part, film.moments, planes.moments);
  copy_out(window, features, part, film.features, planes.features);
  return film;
}

void ImageFilm::put(const Film& film) {
  if (film.is_empty()) return;
  if (!window.contains(film.window) || !film.is_complete() ||
      !film.have(plan, film.window.pixel_count())) {
    throw Error(
        fmt::format("a film of the pixels {}: expected all of its pixels to have samples, "
                    "and the planes of the image {}",
                    text(film.window), text(window)));
  }
  std::vector<FilmPart> after;
  for (const FilmPart& own : parts) {
    for (const Window& rest : subtract(own.window, film.window)) {
      after.push_back({rest, own.first_sample, own.next_sample});
    }
  }
  after.push_back({film.window, film.first_sample, film.next_sample});
  parts = std::move(after);
  const PlaneCounts planes(plan);
  copy_in(window, pixels, film.window, film.pixels, planes.pixels);
  copy_in(window, moments, film.window, film.moments, planes.moments);
  copy_in(window, features, film.window, film.features, planes.features);
  tally = tally + film.tally;
}

std::vector<FilmPart> ImageFilm::lacking(const Window& where, std::uint32_t next_sample) const {
  std::vector<Window> blank{where};
  std::vector<FilmPart> found;
  for (const FilmPart& own : parts) {
    std::vector<Window> rest;
    for (const Window& w : blank) std::ranges::move(subtract(w, own.window), back_inserter(rest));
    blank = std::move(rest);
    const Window common = intersect(own.window, where);
    if (common.pixel_count() > 0 && own.next_sample < next_sample) {
      found.push_back({common, own.first_sample, own.next_sample});
    }
  }
  for (const Window& w : blank) found.push_back({w, 0, 0});
  std::ranges::stable_sort(found, {}, &FilmPart::next_sample);
  return found;
}

std::uint32_t ImageFilm::least_samples(const std::vector<Window>& where) const {
  std::uint32_t least = ~0u;
  for (const Window& w : where) {
    for (const FilmPart& part : lacking(w, ~0u)) {
      least = std::min(least, part.next_sample - part.first_sample);
    }
  }
  return least;
}

std::uint64_t ImageFilm::samples() const {
  std::uint64_t sum = 0;
  for (const FilmPart& part : parts) sum += part.samples();
  return sum;
}

}  // namespace pt
