#include "common/render/film_renderer.h"

#include <fmt/format.h>

#include "common/error.h"
#include "common/film/develop.h"

namespace pt {

FilmRenderer::FilmRenderer(const Options& options)
    : options_(options),
      limits_(path_limits_of(options)),
      window_(blank_film(options.width, options.height).window) {}

RenderRun FilmRenderer::render(const RenderHooks& hooks) {
  return add_samples(blank_film(options_.width, options_.height), options_.spp, hooks);
}

RenderRun FilmRenderer::render(Film& film, int samples, const RenderHooks& hooks) {
  check(film, samples);
  const RenderRun run = add_samples(film, samples, hooks);
  read_film(film);
  film.next_sample += static_cast<std::uint32_t>(run.samples_done);
  film.parts = {film.window};
  return run;
}

void FilmRenderer::check(const Film& film, int samples) const {
  const Window& w = film.window;
  if (w.pixel_count() == 0 || !blank_film(options_.width, options_.height).window.contains(w)) {
    throw Error(
        fmt::format("a film of {}x{} pixels at {},{}: expected a part of the image of "
                    "{}x{} pixels",
                    w.width, w.height, w.x, w.y, options_.width, options_.height));
  }
  if (!film.is_empty() && !film.is_complete()) {
    throw Error(
        fmt::format("a film of {}x{} pixels: some lack samples; expected all or none to "
                    "have them",
                    w.width, w.height));
  }
  if (samples < 1 || ~film.next_sample < static_cast<std::uint32_t>(samples)) {
    throw Error(fmt::format("{} samples after {}: expected at least 1, and fewer than 2^32 in all",
                            samples, film.next_sample));
  }
}

RenderRun FilmRenderer::add_samples(const Film& film, int samples, const RenderHooks& hooks) {
  window_ = film.window;
  const std::uint64_t pixels = window_.pixel_count();
  const auto render_samples = [&](RenderRun& run, int first, int count) {
    const std::uint32_t first_sample = film.next_sample + static_cast<std::uint32_t>(first);
    render_batch({samples_, window_, first_sample, static_cast<std::uint32_t>(count)}, run);
  };
  begin_render(film);
  RenderRun run;
  run.samples_done =
      for_each_batch(samples, batch_samples(samples, pixels, batch_paths_), pixels, hooks,
                     [&](int first, int count) { render_samples(run, first, count); });
  end_render(run);
  return run;
}

Image FilmRenderer::image() {
  Film film;
  film.window = window_;
  read_film(film);
  return develop(film.pixels, static_cast<int>(window_.width), static_cast<int>(window_.height));
}

}  // namespace pt
