#include "common/render/batches.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/error/host_memory.h"
#include "common/render/stop_clock.h"

namespace pt {
namespace {

constexpr std::uint64_t paths_end = std::uint64_t{1} << 31;  // a path's number has a bit to spare
constexpr double watched_batch_s = 0.2;

}  // namespace

Window window_of(const Options& options) {
  const CropWindow crop = options.crop.value_or(CropWindow{0, 0, options.width, options.height});
  return {static_cast<std::uint32_t>(crop.x0), static_cast<std::uint32_t>(crop.y0),
          static_cast<std::uint32_t>(crop.x1 - crop.x0),
          static_cast<std::uint32_t>(crop.y1 - crop.y0)};
}

std::uint64_t plan_batches(const Options& options, const FilmMemory& memory) {
  const Window window = window_of(options);
  const std::uint64_t pixels = window.pixel_count();
  const std::uint64_t film_bytes = pixels * memory.bytes_per_pixel;
  const std::uint64_t least = film_bytes + pixels * memory.bytes_per_path;
  if (least > memory.free_bytes) {
    throw memory_error(memory.name,
                       fmt::format("an image of {} x {} pixels", window.width, window.height),
                       least, memory.free_bytes);
  }
  if (pixels >= paths_end) {
    throw Error(fmt::format("--width {} --height {}: expected fewer than 2^31 pixels",
                            options.width, options.height));
  }
  const std::uint64_t room = std::max(memory.free_bytes / 2, least) - film_bytes;
  const std::uint64_t paths_max = std::min(memory.batch_paths_max, room / memory.bytes_per_path);
  return pixels * static_cast<std::uint64_t>(batch_samples(options.spp, pixels, paths_max));
}

int batch_samples(int spp, std::uint64_t pixels, std::uint64_t paths_max) {
  const std::uint64_t limit = std::min(paths_max, paths_end - 1);
  const auto wanted = static_cast<std::uint64_t>(spp);
  const std::uint64_t fitting = std::clamp<std::uint64_t>(limit / pixels, 1, wanted);
  const std::uint64_t batches = (wanted + fitting - 1) / fitting;
  return static_cast<int>((wanted + batches - 1) / batches);
}

int BatchPace::next(int left, std::uint64_t pixels, double batch_s) const {
  const double fitting = (paths_per_s_ > 0 ? batch_s * paths_per_s_ : double(first_paths_)) /
                         static_cast<double>(pixels);
  if (left <= 1.5 * fitting) return left;
  return std::max(1, static_cast<int>(fitting));
}

BatchRun for_each_batch(int spp, int per_batch, std::uint64_t pixels, const RenderHooks& hooks,
                        const std::function<bool(int first_sample, int samples)>& run_batch,
                        const std::function<double()>& error, BatchPace* pace) {
  const std::uint64_t total = pixels * static_cast<std::uint64_t>(spp);
  const bool is_watched = static_cast<bool>(hooks.watch);
  const auto paced = [&](int left, bool is_first) {
    if (pace == nullptr) return left;
    if (is_watched && is_first) return 1;
    return pace->next(left, pixels, is_watched ? watched_batch_s : BatchPace::usual_s);
  };
  StopClock clock(hooks.stops);
  BatchRun run;
  while (run.samples < spp) {
    const int left = spp - run.samples;
    const int samples =
        std::min({per_batch, left, clock.next(run.samples), paced(left, run.samples == 0)});
    const double begin_s = clock.elapsed_s();
    if (!run_batch(run.samples, samples)) {
      run.ended_by = RunEnd::interrupted;
      break;
    }
    run.samples += samples;
    if (pace != nullptr) {
      pace->note(pixels * static_cast<std::uint64_t>(samples), clock.elapsed_s() - begin_s);
    }
    if (clock.wants_error(run.samples)) run.relative_error = error();
    const std::uint64_t paths = pixels * static_cast<std::uint64_t>(run.samples);
    if (hooks.progress) hooks.progress(paths, clock.expected(paths, total, run.relative_error));
    if (run.samples < spp) run.ended_by = clock.ends(run.samples, run.relative_error);
    if (run.ended_by != RunEnd::samples) break;
    if (hooks.stop && hooks.stop()) {
      if (run.samples < spp) run.ended_by = RunEnd::interrupted;
      break;
    }
  }
  return run;
}

}  // namespace pt
