// The samples of an image are taken in batches: the sample buffer holds one batch, and between two
// the render can report, be interrupted or be resumed.
#pragma once

#include <cstdint>
#include <functional>

#include "common/render/renderer.h"

namespace pt {

/// What the film and the samples of an image may take of a device's memory.
struct FilmMemory {
  const char* name;  ///< "memory" or "device memory"
  std::uint64_t free_bytes;
  std::uint64_t bytes_per_pixel;
  std::uint64_t bytes_per_path;   ///< sample and, if it is stored, random state
  std::uint64_t batch_paths_max;  ///< more do not pay
};

/// Paths of the largest batch, for which a sample buffer is made: half of the free memory is left
/// to the path pool and to others. Throws Error when one sample per pixel does not fit, and for an
/// image of 2^31 pixels or more.
std::uint64_t plan_batches(const Options& options, const FilmMemory& memory);

/// The pixels that the options ask for: the crop window, or the whole image.
Window window_of(const Options& options);

/// Samples per pixel of one batch: as many of `spp` as fit into `paths_max` paths, at least one.
/// Batches are of equal size but for the last, and never exceed 2^31 - 1 paths.
int batch_samples(int spp, std::uint64_t pixels, std::uint64_t paths_max);

/// What was taken, and why no more.
struct BatchRun {
  int samples = 0;  ///< per pixel
  RunEnd ended_by = RunEnd::samples;
  std::optional<double> relative_error;  ///< the last estimate
};

/// Calls run_batch(first_sample, samples) until `spp` samples are taken or the hooks stop it. With
/// a StopRule batches are no larger than it says, and `error` is asked where it wants to know.
BatchRun for_each_batch(int spp, int per_batch, std::uint64_t pixels, const RenderHooks& hooks,
                        const std::function<void(int first_sample, int samples)>& run_batch,
                        const std::function<double()>& error = {});

}  // namespace pt
