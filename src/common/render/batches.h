// The samples of an image are taken in batches: the sample buffer holds one batch, and between two
// the render can report, be interrupted or be resumed.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "common/render/renderer.h"

namespace pt {

/// What the film and the samples of an image may take of a device's memory.
struct FilmMemory {
  const char* name;  ///< "memory" or "device memory"
  std::uint64_t free_bytes;
  std::uint64_t bytes_per_pixel;
  std::uint64_t bytes_per_path;                 ///< sample and, if it is stored, random state
  std::uint64_t batch_paths_max;                ///< more do not pay
  std::uint64_t first_paths = batch_paths_max;  ///< of a batch of unknown duration
};

/// How large batches are, so that whoever waits for the end of one does not wait long: as many
/// samples as take so long at the rate of the last batch. Images do not depend on it.
class BatchPace {
 public:
  static constexpr double usual_s = 0.5;

  /// `first_paths`: while the rate is not known.
  explicit BatchPace(std::uint64_t first_paths) : first_paths_(first_paths) {}

  /// Samples of the next batch, at least one; `left` of them if these take little longer.
  int next(int left, std::uint64_t pixels) const;
  void note(std::uint64_t paths, double seconds) {
    if (seconds > 0) paths_per_s_ = static_cast<double>(paths) / seconds;
  }

 private:
  std::uint64_t first_paths_;
  double paths_per_s_ = 0;  ///< 0: not known
};

/// Paths of the largest batch, for which a sample buffer is made: half of the free memory is left
/// to the path pool and to others. Throws Error when one sample per pixel does not fit, and for an
/// image of 2^31 pixels or more.
std::uint64_t plan_batches(const ImageSettings& settings, const FilmMemory& memory);

/// The pixels that the options ask for: the crop window, or the whole image.
Window window_of(const ImageSettings& settings);

/// Samples per pixel of one batch: as many of `spp` as fit into `paths_max` paths, at least one.
/// Batches are of equal size but for the last, and never exceed 2^31 - 1 paths.
int batch_samples(int spp, std::uint64_t pixels, std::uint64_t paths_max);

/// What was taken, and why no more.
struct BatchRun {
  int samples = 0;  ///< per pixel
  RunEnd ended_by = RunEnd::samples;
  std::optional<double> relative_error;  ///< the last estimate
};

/// Calls run_batch(first_sample, samples) until `spp` samples are taken, the hooks stop it, or it
/// returns false: then the batch was abandoned. Batches have at most `per_batch` samples, and are
/// no larger than a StopRule and `pace` say; `error` is asked where the rule wants to know.
BatchRun for_each_batch(int spp, int per_batch, std::uint64_t pixels, const RenderHooks& hooks,
                        const std::function<bool(int first_sample, int samples)>& run_batch,
                        const std::function<double()>& error = {}, BatchPace* pace = nullptr);

/// Decides when a render ends that has a limit of time or of error, and how large its batches are
/// until then. It always ends between two batches: what it has is the image of so many samples.
class StopClock {
 public:
  /// Starts to measure. `rule` must live as long.
  explicit StopClock(const StopRule& rule);

  /// The most samples that the next batch may have. For the time: at first as many as there are,
  /// then as many as fit into what is left at the rate so far. For the error: up to the next of
  /// the numbers at which it is estimated, which do not depend on time or device.
  int next(int done) const;
  /// `done` is one of these numbers: 16, and then a quarter more each time.
  bool wants_error(int done) const;
  /// To be called after a batch. RunEnd::samples: continue.
  RunEnd ends(int done, std::optional<double> error) const;
  /// The samples that there will be in all, for a progress bar.
  std::uint64_t expected(std::uint64_t done, std::uint64_t total,
                         std::optional<double> error) const;
  double elapsed_s() const;

 private:
  double now_s() const;

  const StopRule& rule_;
  double begin_s_;
};

}  // namespace pt
