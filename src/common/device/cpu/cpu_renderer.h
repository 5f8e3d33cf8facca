// What all modes share on the CPU: the memory of the film, the clock and the threads.
#pragma once

#include <tbb/task_arena.h>

#include <chrono>
#include <vector>

#include "common/device/cpu/cpu_chains.h"
#include "common/render/dispatch.h"
#include "common/render/film_renderer.h"
#include "common/render/settings_of.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// Adds up wall time by stage, in the order in which the stages first appear.
class StageTimer {
 public:
  template <class Function>
  void time(const std::string& stage, Function&& function) {
    const auto start = std::chrono::steady_clock::now();
    function();
    const std::chrono::duration<double, std::milli> elapsed =
        std::chrono::steady_clock::now() - start;
    add({stage, elapsed.count(), 1});
  }
  /// Adds the times of another clock, each multiplied by `share`, and its launches.
  void add(const StageTimer& other, double share);
  void reset() { stages_.clear(); }
  const std::vector<StageTime>& stages() const { return stages_; }

 private:
  void add(const StageTime& time);
  std::vector<StageTime> stages_;
};

class CpuRenderer : public FilmRenderer {
 public:
  /// `scene` must outlive the renderer. Throws Error when the machine's memory cannot hold the
  /// film.
  CpuRenderer(const ExecutionPlan& plan, const SceneData& scene);

  Image image() override;  ///< without a copy of the film
  bool set_camera(const Camera& camera) override;
  bool set_scene(const SceneData& scene, const SceneChanges& changes) override;
  void describe(RenderReport& report) const override;

 protected:
  /// Traces every path of the batch and stores its sample. Runs inside the task arena.
  virtual void trace_batch(const SampleBuffer& batch) = 0;

  /// Calls function(source) with the options' random source, its states initialised for `batch`.
  template <class Function>
  void with_random_source(const SampleBuffer& batch, Function&& function) {
    if (plan_.rng == RngKind::xorwow) {
      timer_.time("render_init", [&] { init_random_states(batch); });
    }
    const Chains* const chains = chains_ == nullptr ? nullptr : chains_->numbers();
    pt::with_random_source(plan_, traits_, states_.data(), chains, function);
  }

  /// Whether the batch is to be abandoned: no path more needs to be traced.
  bool is_cancelled() const { return cancel_ != nullptr && *cancel_ && (*cancel_)(); }

  void note_memory(const char* name, std::uint64_t size_bytes);
  int threads() const { return threads_; }

  const SceneTraits traits_;
  Scene scene_;
  StageTimer timer_;
  std::uint64_t waves_ = 0;
  std::uint64_t pool_size_ = 0;

 private:
  friend class CpuChains;  // another user of the arena, the clock and trace_batch

  ChainDevice& chain_device() override { return *chains_; }
  void store_film(const Film& film) override;
  void begin_render(const Film* film) override;
  bool render_batch(const SampleBuffer& batch, RenderRun& run,
                    const std::function<bool()>& cancel) override;
  void end_render(RenderRun& run) override;
  void read_film(Film& film) override;
  template <class Function>
  void time_in_arena(RenderRun& run, Function&& function) {
    const auto start = std::chrono::steady_clock::now();
    arena_.execute(function);
    const std::chrono::duration<double, std::milli> elapsed =
        std::chrono::steady_clock::now() - start;
    run.kernel_ms += elapsed.count();
  }
  bool trace_whole(const SampleBuffer& batch, const std::function<bool()>& cancel);
  void count_paths(const SampleBuffer& batch);
  void init_random_states(const SampleBuffer& batch);
  void accumulate(const SampleBuffer& batch);
  template <class MakeSum>
  void accumulate_with(const SampleBuffer& batch, MakeSum&& make_sum);
  void accumulate_features(const SampleBuffer& batch);
  FilmView film_view();

  const std::function<bool()>* cancel_ = nullptr;  ///< while a batch of paths is traced
  std::uint32_t first_sample_ = 0;                 ///< of the film
  int threads_;
  tbb::task_arena arena_;
  std::uint64_t primitive_count_;
  double setup_ms_ = 0;
  std::vector<Sample> sample_memory_;
  FilmSums sums_;  ///< of the film that is rendered, the first of their elements
  std::vector<XorwowState> states_;
  PathTally tally_;
  std::unique_ptr<CpuChains> chains_;  ///< only with --integrator mlt
  std::vector<BufferSize> memory_;
};

/// The threads that run where `wanted` are asked for (0: all): no more than oneTBB has for this
/// process, which minds its affinity.
int cpu_threads(int wanted);

}  // namespace pt
