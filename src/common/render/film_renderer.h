// What all renderers share, whatever their mode and device: the film and its batches.
#pragma once

#include "common/film/film_data.h"
#include "common/film/markov_chains.h"
#include "common/plan/execution_plan.h"
#include "common/render/batches.h"
#include "common/render/chain_layout.h"
#include "common/render/renderer.h"
#include "common/render/settings_of.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// Throws Error where the film's planes, its filter or the integrator need what the settings or the
/// scene do not allow.
void check_film(const ImageSettings& settings, const SceneProperties& scene,
                const PixelFilter& filter);

/// A device holds the film's pixels and counts while it renders, and after: `film` is the rest.
class FilmRenderer : public Renderer {
 public:
  RenderRun render(const RenderHooks& hooks) final;
  RenderRun render(Film& film, int samples, const RenderHooks& hooks) final;
  RenderRun add(int samples, const RenderHooks& hooks) final;
  Image image() override;

 protected:
  FilmRenderer(const ExecutionPlan& plan, const SceneData& scene);

  /// To be called once, before a render: `make(paths)` makes a sample buffer for the largest batch.
  template <class Make>
  void make_samples(const FilmMemory& memory, const ChainDefaults& defaults, Make&& make) {
    if (has_chains()) {
      chain_plan_ = plan_chains(plan_, defaults, memory);
      batch_paths_ = chain_plan_.batch_paths();
    } else {
      batch_paths_ = plan_batches(plan_, memory);
    }
    pace_ = BatchPace(memory.first_paths);
    samples_ = make(batch_paths_);
  }

  bool has_chains() const { return plan_.integrator == IntegratorKind::mlt; }
  ChainLayout chain_layout() const {
    return {chain_plan_, image_window_.pixel_count(), samples_, plan_.seed,
            mutation_size(plan_.mutation_size)};
  }
  /// With has_chains().
  virtual ChainDevice& chain_device() = 0;
  /// Whether trace_batch asks supply() for paths; else indices do not repeat.
  virtual bool can_repeat_paths() const { return true; }
  /// Whether paths will repeat in some batches of this render.
  bool paths_repeat() const { return has_chains() && can_repeat_paths(); }
  /// The supply of the batch that is traced.
  const PathSupply& supply() const { return supply_; }
  void set_supply(const PathSupply& supply) { supply_ = supply; }

  /// add() then begins with no samples.
  void forget_film() { pixel_samples_ = 0; }
  /// What films there are: parts of the crop window, or of the whole image.
  const Window& image_window() const { return image_window_; }
  /// An image of the window of the last render, without pixels, and a black one.
  Image frame() const;
  Image blank_image() const;
  /// `sums` as an image of that window.
  Image develop_window(const FilmSums& sums) const;
  /// Paths of the largest batch.
  std::uint64_t batch_paths() const { return batch_paths_; }
  Sample* samples() const { return samples_; }

  /// Takes the film to the device (no pixels: black ones).
  virtual void store_film(const Film& film) = 0;
  /// The same, and begins to measure. Null: the film is that of the last render.
  virtual void begin_render(const Film* film) = 0;
  /// Traces the batch, adds it to the device's film and its time to `run`. False: `cancel`, a hook,
  /// abandoned it, and the film is as before.
  virtual bool render_batch(const SampleBuffer& batch, RenderRun& run,
                            const std::function<bool()>& cancel) = 0;
  /// Notes what was measured since begin_render but the batches' time.
  virtual void end_render(RenderRun& run) = 0;
  /// Fills in the pixels and counts of a film, whose window is that of the last render.
  virtual void read_film(Film& film) = 0;

  /// Fills in what the plan decided.
  void describe_plan(RenderReport& report) const;

  const ExecutionPlan plan_;
  const PathSettings path_settings_;
  const FilmPlan film_plan_;  ///< what is summed
  const PixelFilter filter_;  ///< without its table

 private:
  void check(const Film& film, int samples) const;
  RenderRun start(const Film& film, int samples, const RenderHooks& hooks);
  RenderRun add_samples(int samples, const RenderHooks& hooks);
  RenderRun add_mutations(const Film& film, int samples, const RenderHooks& hooks);
  double estimate_error();
  ImagePlace place_of_window() const;

  Window image_window_;
  Window window_;
  std::uint32_t first_sample_ = 0;
  std::uint64_t pixel_samples_ = 0;
  std::uint64_t batch_paths_ = 0;
  BatchPace pace_{1};
  ChainPlan chain_plan_;
  Sample* samples_ = nullptr;
  PathSupply supply_;
};

}  // namespace pt
