#include "common/render/batches.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error/host_memory.h"
#include "common/platform/steady_seconds.h"

namespace pt {
namespace {

constexpr std::uint64_t paths_end = std::uint64_t{1} << 31;  // a path's number has a bit to spare

}  // namespace

Window window_of(const ImageSettings& settings) {
  const CropWindow crop = settings.crop.value_or(CropWindow{0, 0, settings.width, settings.height});
  return {static_cast<std::uint32_t>(crop.x0), static_cast<std::uint32_t>(crop.y0),
          static_cast<std::uint32_t>(crop.x1 - crop.x0),
          static_cast<std::uint32_t>(crop.y1 - crop.y0)};
}

std::uint64_t plan_batches(const ImageSettings& settings, const FilmMemory& memory) {
  const Window window = window_of(settings);
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
                            settings.width, settings.height));
  }
  const std::uint64_t room = std::max(memory.free_bytes / 2, least) - film_bytes;
  const std::uint64_t paths_max = std::min(memory.batch_paths_max, room / memory.bytes_per_path);
  return pixels * static_cast<std::uint64_t>(batch_samples(settings.spp, pixels, paths_max));
}

int batch_samples(int spp, std::uint64_t pixels, std::uint64_t paths_max) {
  const std::uint64_t limit = std::min(paths_max, paths_end - 1);
  const auto wanted = static_cast<std::uint64_t>(spp);
  const std::uint64_t fitting = std::clamp<std::uint64_t>(limit / pixels, 1, wanted);
  const std::uint64_t batches = (wanted + fitting - 1) / fitting;
  return static_cast<int>((wanted + batches - 1) / batches);
}

int BatchPace::next(int left, std::uint64_t pixels) const {
  const double fitting = (paths_per_s_ > 0 ? usual_s * paths_per_s_ : double(first_paths_)) /
                         static_cast<double>(pixels);
  if (left <= 1.5 * fitting) return left;
  return std::max(1, static_cast<int>(fitting));
}

BatchRun for_each_batch(int spp, int per_batch, std::uint64_t pixels, const RenderHooks& hooks,
                        const std::function<bool(int first_sample, int samples)>& run_batch,
                        const std::function<double()>& error, BatchPace* pace) {
  const std::uint64_t total = pixels * static_cast<std::uint64_t>(spp);
  StopClock clock(hooks.stops);
  BatchRun run;
  while (run.samples < spp) {
    const int left = spp - run.samples;
    const int paced = pace != nullptr ? pace->next(left, pixels) : left;
    const int samples = std::min({per_batch, left, clock.next(run.samples), paced});
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

namespace {

constexpr int first_check = 16;  // fewer samples say little of their variance
constexpr int no_limit = std::numeric_limits<int>::max();

/// The first number above `done` at which the error is estimated.
int next_check(int done) {
  std::int64_t check = first_check;
  while (check <= done) check += std::max<std::int64_t>(check / 4, 1);
  return static_cast<int>(std::min<std::int64_t>(check, no_limit));
}

}  // namespace

StopClock::StopClock(const StopRule& rule) : rule_(rule), begin_s_(now_s()) {}

double StopClock::now_s() const {
  if (rule_.clock) return rule_.clock();
  return steady_seconds();
}

double StopClock::elapsed_s() const { return now_s() - begin_s_; }

int StopClock::next(int done) const {
  int samples = no_limit;
  if (rule_.relative_error > 0) samples = next_check(done) - done;
  if (rule_.seconds > 0) {
    const double elapsed = elapsed_s();
    const double fitting = elapsed > 0 ? done * (rule_.seconds - elapsed) / elapsed : 1.0;
    const double most = std::min(fitting, static_cast<double>(std::max(done, 1)));
    samples = std::min(samples, std::max(1, static_cast<int>(std::min(most, 1e9))));
  }
  return samples;
}

bool StopClock::wants_error(int done) const {
  return rule_.relative_error > 0 && done >= first_check && next_check(done - 1) == done;
}

RunEnd StopClock::ends(int done, std::optional<double> error) const {
  if (rule_.relative_error > 0 && wants_error(done) && error <= rule_.relative_error) {
    return RunEnd::target_error;
  }
  if (rule_.seconds <= 0) return RunEnd::samples;
  // A sample more would end later than the limit by more than this one would be early.
  const double elapsed = elapsed_s();
  const double sample_s = elapsed / std::max(done, 1);
  return elapsed + 0.5 * sample_s >= rule_.seconds ? RunEnd::time_limit : RunEnd::samples;
}

std::uint64_t StopClock::expected(std::uint64_t done, std::uint64_t total,
                                  std::optional<double> error) const {
  double all = static_cast<double>(total);
  const double now = static_cast<double>(done);
  if (rule_.seconds > 0) {
    const double elapsed = elapsed_s();
    if (elapsed > 0) all = std::min(all, now * std::max(1.0, rule_.seconds / elapsed));
  }
  if (rule_.relative_error > 0 && error) {
    const double ratio = *error / rule_.relative_error;
    all = std::min(all, now * std::max(1.0, ratio * ratio));
  }
  return static_cast<std::uint64_t>(all);
}

}  // namespace pt
