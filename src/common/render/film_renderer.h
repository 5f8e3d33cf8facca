// What all renderers share, whatever their mode and device: the film and its batches.
#pragma once

#include "common/film/film_data.h"
#include "common/render/batches.h"
#include "common/render/path_limits_of.h"
#include "common/render/renderer.h"
#include "common/scene/scene_data.h"

namespace pt {

/// A device holds the film's pixels and counts while it renders, and after: `film` is the rest.
class FilmRenderer : public Renderer {
 public:
  RenderRun render(const RenderHooks& hooks) final;
  RenderRun render(Film& film, int samples, const RenderHooks& hooks) final;
  Image image() override;

 protected:
  FilmRenderer(const Options& options, const SceneData& scene);

  /// To be called once, before a render: `make(paths)` makes a sample buffer for the largest batch.
  template <class Make>
  void make_samples(const FilmMemory& memory, Make&& make) {
    batch_paths_ = plan_batches(options_, memory);
    samples_ = make(batch_paths_);
  }

  /// Of the last render.
  const Window& window() const { return window_; }
  /// The samples that each pixel has.
  std::uint64_t pixel_samples() const { return pixel_samples_; }
  /// What films there are: parts of the crop window, or of the whole image.
  const Window& image_window() const { return image_window_; }
  /// `sums` as an image, of the window of the last render.
  Image develop_window(const FilmSums& sums) const;
  /// Paths of the largest batch.
  std::uint64_t batch_paths() const { return batch_paths_; }
  Sample* samples() const { return samples_; }

  /// Takes the film to the device (no pixels: black ones) and begins to measure.
  virtual void begin_render(const Film& film) = 0;
  /// Traces the batch, adds it to the device's film and its time to `run`.
  virtual void render_batch(const SampleBuffer& batch, RenderRun& run) = 0;
  /// Notes what was measured since begin_render but the batches' time.
  virtual void end_render(RenderRun& run) = 0;
  /// Fills in the pixels and counts of a film, whose window is that of the last render.
  virtual void read_film(Film& film) = 0;

  const Options options_;
  const PathLimits limits_;
  const FilmPlan plan_;       ///< what is summed
  const PixelFilter filter_;  ///< without its table

 private:
  void check(const Film& film, int samples) const;
  RenderRun add_samples(const Film& film, int samples, const RenderHooks& hooks);
  double estimate_error();

  Window image_window_;
  Window window_;
  std::uint64_t pixel_samples_ = 0;
  std::uint64_t batch_paths_ = 0;
  Sample* samples_ = nullptr;
};

}  // namespace pt
