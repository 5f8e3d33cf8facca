// What the modes share on CUDA: the scene's upload, the memory of the film, launches, the clocks.
#pragma once

#include <cuda_runtime_api.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "common/cuda/cuda_check.cuh"
#include "common/cuda/cuda_memory.cuh"
#include "common/device/cuda/counter_session_cuda.h"
#include "common/device/cuda/scene_storage.cuh"
#include "common/device/cuda/stage_clock.h"
#include "common/render/dispatch.h"
#include "common/render/film_renderer.h"
#include "common/render/random_source.h"
#include "common/scene/data/scene_data.h"

namespace pt {

struct CurandState;

class CudaRenderer : public FilmRenderer {
 public:
  /// Throws Error when the scene, the film or the options do not fit the device.
  CudaRenderer(const Options& options, const SceneData& scene, int device);
  ~CudaRenderer() override;

  void describe(RenderReport& report) const override;
  HardwareCounters count_hardware() override;

 protected:
  /// Makes everything that a batch needs and that is no part of its time (graphs, for example).
  virtual void prepare_batch(const SampleBuffer& /*batch*/) {}
  /// Enqueues the kernels that trace the batch on stream().
  virtual void trace_batch(const SampleBuffer& batch) = 0;
  /// Waves run since the last call; 0 in modes without waves.
  virtual std::uint64_t take_wave_count() { return 0; }
  /// Fills in what the layout of the data lets expect of each launch of the last batch.
  virtual void predict_bytes(std::vector<LaunchCounters>& /*launches*/) const {}

  /// Whether trace_batch looks at chains(); else chains take their steps one batch after the other.
  virtual bool runs_chains_async() const { return true; }
  /// Null: the batch is of paths. Else, in the device's memory, of asynchronous chains
  /// (continue_chain); so it is from prepare_batch on.
  const ChainRun* chains() const { return chains_are_async_ ? chain_run_ : nullptr; }

  /// Whether the hardware's counters are read: every kernel is then launched by the host.
  bool is_counting() const { return counters_ != nullptr; }
  /// What follows belongs to this wave; -1: to none.
  void set_wave(int wave) { wave_ = wave; }

  /// Launches a kernel on stream() inside an NVTX range of its name and notes its resources.
  /// Throws Error when the device cannot run a block of this size.
  template <class... Parameters, class... Arguments>
  void launch(const char* name, void (*kernel)(Parameters...), dim3 grid, dim3 block,
              std::size_t shared_bytes, const Arguments&... arguments) {
    launch_erased(name, reinterpret_cast<const void*>(kernel), grid, block, shared_bytes,
                  Pack<Parameters...>(arguments...).pointers());
  }

  /// Calls `enqueue`, which launches a library's kernels on stream(), as many in each call of one
  /// kind; they are counted under this name.
  void launch_others(const char* name, int kind, const std::function<void()>& enqueue);

  /// Blocks of `kernel` that the device holds at once.
  std::uint32_t resident_blocks(const void* kernel, int block_threads, std::size_t shared_bytes);

  /// Calls function(storage, shared_bytes) with the scene where --scene-memory wants its spheres.
  template <class Function>
  void with_scene_storage(Function&& function) const {
    if (execution_.scene_memory == SceneMemory::shared) {
      function(SceneStorage<SceneMemory::shared>{scene_},
               half_spheres_.size() * sizeof(HalfSpheres));
    } else if (execution_.scene_memory == SceneMemory::constant) {
      SceneStorage<SceneMemory::constant> storage{scene_, {}};
      std::copy(half_spheres_.begin(), half_spheres_.end(), storage.spheres);
      function(storage, std::size_t{0});
    } else {
      function(SceneStorage<SceneMemory::global>{scene_}, std::size_t{0});
    }
  }

  /// Calls function(source) with the options' random source.
  template <class Function>
  void with_random_source(Function&& function) const {
    pt::with_random_source(options_, traits_, states_, chain_arrays_.chains, function);
  }

  cudaStream_t stream() const { return stream_; }
  StageClock* clock() const { return clock_; }

  const cudaDeviceProp properties_;
  const SceneTraits traits_;
  Scene scene_;  ///< a view of device memory
  CudaMemory memory_;
  std::uint64_t pool_size_ = 0;

 private:
  void upload(const SceneData& scene);
  void allocate_film();
  void allocate_planes(std::uint64_t pixels);
  /// The arguments of a launch, converted to the kernel's parameters and listed by address.
  template <class... Parameters>
  class Pack {
   public:
    template <class... Arguments>
    explicit Pack(const Arguments&... arguments) : values_(arguments...) {}
    void** pointers() {
      std::apply(
          [this](auto&... value) {
            pointers_ = {const_cast<void*>(static_cast<const void*>(&value))...};
          },
          values_);
      return pointers_.data();
    }

   private:
    std::tuple<std::remove_cv_t<Parameters>...> values_;
    std::array<void*, sizeof...(Parameters)> pointers_{};
  };

  int count_kernels(const std::function<void()>& enqueue) const;
  void launch_erased(const char* name, const void* kernel, dim3 grid, dim3 block,
                     std::size_t shared_bytes, void** arguments);
  void note_kernel(const char* name, const void* kernel, dim3 block, std::size_t shared_bytes);
  void load_kernels();
  void allocate_chains();
  template <class Enqueue>
  void time_batch(RenderRun& run, Enqueue&& enqueue);
  void store_film(const Film& film) override;
  void begin_render(const Film& film) override;
  bool render_batch(const SampleBuffer& batch, RenderRun& run,
                    const std::function<bool()>& cancel) override;
  void end_render(RenderRun& run) override;
  void read_film(Film& film) override;
  void begin_chains(const ChainWindow& window) override;
  bool trace_bootstrap(std::uint32_t first, std::uint32_t count, RenderRun& run,
                       const std::function<bool()>& cancel) override;
  void splat_bootstrap(std::uint32_t count, const ChainStep& step, RenderRun& run) override;
  std::vector<TargetSum> sum_targets(std::uint32_t paths, RenderRun& run) override;
  void start_chains(const ChainStarts& starts, const ChainStep& step, RenderRun& run) override;
  void mutate_chains(std::uint32_t chains, const ChainStep& step, std::uint32_t last,
                     RenderRun& run) override;
  void finish_chains(std::uint32_t chains, const ChainStep& step, RenderRun& run) override;
  ChainSums take_chain_sums() override;
  void clear_chain_sums();
  void run_chains(std::uint32_t chains, const ChainStep& step, RenderRun& run);
  template <class... Parameters, class... Arguments>
  void launch_each(const char* name, void (*kernel)(Parameters...), std::uint32_t count,
                   const Arguments&... arguments);
  template <class SomeFilm, class Function>
  void for_each_film_array(SomeFilm& film, Function&& function) const;
  void accumulate(const SampleBuffer& batch);
  PathTally read_tally() const;
  void read_clock(RenderRun& run);
  std::vector<LaneHistogram> read_lane_counts() const;

  int device_;
  std::string driver_;
  std::uint64_t primitive_count_;
  TreeFacts tree_facts_;  ///< of a tree built on the device
  std::vector<HalfSpheres> half_spheres_;
  cudaStream_t stream_ = nullptr;
  cudaEvent_t start_ = nullptr, stop_ = nullptr;
  FilmView film_;  ///< of the film that is rendered, the first of the arrays' elements
  PathTally* tally_ = nullptr;
  ChainArrays chain_arrays_;  ///< null without --integrator mlt
  ChainRun* chain_run_ = nullptr;
  bool chains_are_async_ = false;
  std::uint32_t chain_steps_ = 0;  ///< that each chain has taken, where chains are not asynchronous
  CurandState* states_ = nullptr;
  StageClock* clock_ = nullptr;
  std::unique_ptr<CounterSession> counters_;           ///< while they are read
  std::map<std::pair<std::string, int>, int> others_;  ///< kernels of launch_others, by its call
  int wave_ = -1;
  LaneCounts* lane_counts_ = nullptr;  ///< null: this build counts none
  std::vector<KernelInfo> kernels_;
  /// Of kernels_; one may run as several stages.
  std::vector<std::pair<const void*, std::string>> noted_kernels_;
  double setup_ms_ = 0;
  double load_ms_ = 0;  ///< 0: not loaded yet
  double transfer_ms_ = 0;
};

}  // namespace pt
