#include "common/render/film_renderer.h"

#include <fmt/format.h>

#include "common/error/error.h"
#include "common/film/develop.h"
#include "common/film/pixel_statistics.h"
#include "common/options/option_names.h"
#include "common/render/settings_of.h"

namespace pt {

// Features and signs are found from the numbers that begin a path, drawn a second time.
void check_film(const ImageSettings& settings, const SceneProperties& scene,
                const PixelFilter& filter) {
  check_metropolis(settings, scene, filter);
  if (settings.rng == RngKind::philox) return;
  const FilmPlan film = film_plan_of(settings, filter);
  if (film.feature_planes() == 0 && !film.two_signs) return;
  throw Error(fmt::format(
      "--rng {}: its numbers cannot be drawn twice, which {} needs; expected "
      "--rng philox",
      to_string(settings.rng), film.two_signs ? "a --filter with negative parts" : "--aov"));
}

FilmRenderer::FilmRenderer(const ExecutionPlan& plan, const SceneData& scene)
    : plan_(plan),
      path_settings_(path_settings_of(plan, plan.path_bytes)),
      film_plan_(film_plan_of(plan, scene.filter)),
      filter_(scene.filter),
      image_window_(window_of(plan)),
      window_(image_window_) {}

void FilmRenderer::describe_plan(RenderReport& report) const {
  report.plan = plan_.decisions;
  report.calibration = plan_.calibration;
  report.mode = to_string(plan_.mode);
  if (plan_.mode != Mode::wavefront) return;
  report.stages = to_string(plan_.fused ? Stages::fused : Stages::split);
  report.finish_paths = plan_.finish_paths;
  if (report.device_kind == "cuda") {
    report.schedule = to_string(plan_.uses_graph ? Schedule::graph : Schedule::host);
  }
}

RenderRun FilmRenderer::render(const RenderHooks& hooks) {
  Film film;
  film.window = image_window_;
  return start(film, plan_.spp, hooks);
}

RenderRun FilmRenderer::render(Film& film, int samples, const RenderHooks& hooks) {
  check(film, samples);
  const RenderRun run = start(film, samples, hooks);
  read_film(film);
  film.next_sample += static_cast<std::uint32_t>(run.samples_done);
  film.parts = {film.window};
  return run;
}

RenderRun FilmRenderer::add(int samples, const RenderHooks& hooks) {
  if (has_chains()) {
    throw Error(
        "--integrator mlt: its chains end with their render; expected path, whose samples "
        "can be added to");
  }
  if (pixel_samples_ == 0) {
    Film film;
    film.window = image_window_;
    return start(film, samples, hooks);
  }
  begin_render(nullptr);
  return add_samples(samples, hooks);
}

void FilmRenderer::check(const Film& film, int samples) const {
  const Window& w = film.window;
  if (w.pixel_count() == 0 || !image_window_.contains(w)) {
    throw Error(
        fmt::format("a film of {}x{} pixels at {},{}: expected a part of the image of "
                    "{}x{} pixels{}",
                    w.width, w.height, w.x, w.y, plan_.width, plan_.height,
                    plan_.crop ? ", within --crop" : ""));
  }
  if (!film.is_empty() && !film.is_complete()) {
    throw Error(
        fmt::format("a film of {}x{} pixels: some lack samples; expected all or none to "
                    "have them",
                    w.width, w.height));
  }
  if (!film.is_empty() && !film.have(film_plan_, w.pixel_count())) {
    throw Error(
        fmt::format("a film of {}x{} pixels: expected the planes that --aov, --filter and "
                    "--target-error ask for",
                    w.width, w.height));
  }
  if (has_chains() && !film.is_empty()) {
    throw Error(
        fmt::format("a film of {}x{} pixels: has {} mutations per pixel; the chains of "
                    "--integrator mlt have ended with them, expected a film without samples",
                    w.width, w.height, film.next_sample - film.first_sample));
  }
  if (samples < 1 || ~film.next_sample < static_cast<std::uint32_t>(samples)) {
    throw Error(fmt::format("{} samples after {}: expected at least 1, and fewer than 2^32 in all",
                            samples, film.next_sample));
  }
}

RenderRun FilmRenderer::start(const Film& film, int samples, const RenderHooks& hooks) {
  window_ = film.window;
  if (has_chains()) return add_mutations(film, samples, hooks);
  first_sample_ = film.first_sample;
  pixel_samples_ = film.next_sample - film.first_sample;
  begin_render(&film);
  return add_samples(samples, hooks);
}

RenderRun FilmRenderer::add_samples(int samples, const RenderHooks& hooks) {
  const std::uint64_t pixels = window_.pixel_count();
  const int largest = batch_samples(samples, pixels, batch_paths_);
  RenderRun run;
  const BatchRun batches = for_each_batch(
      samples, largest, pixels, hooks,
      [&](int, int count) {
        const auto next_sample = static_cast<std::uint32_t>(first_sample_ + pixel_samples_);
        const SampleBuffer batch{samples_, window_, next_sample, static_cast<std::uint32_t>(count)};
        if (!render_batch(batch, run, hooks.cancel)) return false;
        pixel_samples_ += static_cast<std::uint64_t>(count);
        return true;
      },
      [&] { return estimate_error(); }, &pace_);
  run.samples_done = batches.samples;
  run.ended_by = batches.ended_by;
  run.relative_error = batches.relative_error;
  end_render(run);
  return run;
}

// The chains' sums become the device's film when they have ended.
RenderRun FilmRenderer::add_mutations(const Film& film, int samples, const RenderHooks& hooks) {
  begin_render(&film);
  Film result;
  result.window = film.window;
  RenderRun run = render_chains(chain_device(), chain_plan_, plan_, samples, hooks, result, &pace_);
  end_render(run);
  Film traced;
  traced.window = film.window;
  read_film(traced);
  result.tally = result.tally + traced.tally;
  result.parts = {film.window};
  store_film(result);
  pixel_samples_ = static_cast<std::uint64_t>(run.samples_done);
  return run;
}

Image FilmRenderer::frame() const {
  Image image;
  image.width = static_cast<int>(window_.width), image.height = static_cast<int>(window_.height);
  image.place = place_of_window();
  return image;
}

Image FilmRenderer::blank_image() const {
  Image image = frame();
  image.rgb.resize(3 * window_.pixel_count());
  return image;
}

Image FilmRenderer::develop_window(const FilmSums& sums) const {
  Image image = develop(sums, film_plan_, filter_, window_, pixel_samples_);
  image.place = place_of_window();
  return image;
}

ImagePlace FilmRenderer::place_of_window() const {
  return {static_cast<int>(window_.x), static_cast<int>(window_.y), plan_.width, plan_.height};
}

Image FilmRenderer::image() {
  Film film;
  film.window = window_;
  read_film(film);
  return develop_window(film);
}

double FilmRenderer::estimate_error() {
  Film film;
  film.window = window_;
  read_film(film);
  const std::uint64_t pixels = window_.pixel_count();
  return relative_error(PixelReader(film, film_plan_, filter_, pixels), pixels, pixel_samples_);
}

}  // namespace pt
