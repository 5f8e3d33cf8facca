#include "common/render/batches.h"

#include <algorithm>

namespace pt {

int batch_samples(int spp, std::uint64_t pixels, std::uint64_t paths_max) {
  const std::uint64_t limit = std::min<std::uint64_t>(paths_max, 0x7fffffffu);
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
