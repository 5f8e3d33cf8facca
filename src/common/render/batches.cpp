#include "common/render/batches.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/memory_error.h"

namespace pt {
namespace {

constexpr std::uint64_t paths_end = std::uint64_t{1} << 31;  // a path's number has a bit to spare

}  // namespace

std::uint64_t plan_batches(const Options& options, const FilmMemory& memory) {
  const std::uint64_t pixels = std::uint64_t(options.width) * std::uint64_t(options.height);
  const std::uint64_t film_bytes = pixels * memory.bytes_per_pixel;
  const std::uint64_t least = film_bytes + pixels * memory.bytes_per_path;
  if (least > memory.free_bytes) {
    throw memory_error(memory.name,
                       fmt::format("an image of {} x {} pixels", options.width, options.height),
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

int for_each_batch(int spp, int per_batch, std::uint64_t pixels, const RenderHooks& hooks,
                   const std::function<void(int first_sample, int samples)>& run_batch) {
  const std::uint64_t total = pixels * static_cast<std::uint64_t>(spp);
  int done = 0;
  while (done < spp) {
    const int samples = std::min(per_batch, spp - done);
    run_batch(done, samples);
    done += samples;
    if (hooks.progress) hooks.progress(pixels * static_cast<std::uint64_t>(done), total);
    if (hooks.stop && hooks.stop()) break;
  }
  return done;
}

}  // namespace pt
