// What the modes share on CUDA: the scene's upload, the memory of the film, batches.
#pragma once

#include <cuda_runtime_api.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "common/cuda/cuda_check.cuh"
#include "common/cuda/cuda_memory.cuh"
#include "common/device/cuda/cuda_chains.cuh"
#include "common/device/cuda/cuda_launcher.cuh"
#include "common/device/cuda/scene_storage.cuh"
#include "common/render/dispatch.h"
#include "common/render/film_renderer.h"
#include "common/render/settings_of.h"
#include "common/scene/data/scene_data.h"

namespace pt {

struct CurandState;

class CudaRenderer : public FilmRenderer, protected CudaLauncher {
 public:
  /// Throws Error when the scene, the film or the options do not fit the device.
  CudaRenderer(const ExecutionPlan& plan, const SceneData& scene, int device);
  ~CudaRenderer() override;

  Image image() override;
  std::unique_ptr<DeviceImage> device_image() override;
  bool set_camera(const Camera& camera) override;
  /// For changes of materials and lights that leave all arrays their sizes, which get their new
  /// values in place, in scenes that stand still.
  bool set_scene(const SceneData& scene, const SceneChanges& changes) override;
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

  /// Calls function(storage, shared_bytes) with the scene where --scene-memory wants its spheres.
  template <class Function>
  void with_scene_storage(Function&& function) const {
    if (plan_.scene_memory == SceneMemory::shared) {
      function(SceneStorage<SceneMemory::shared>{scene_},
               half_spheres_.size() * sizeof(HalfSpheres));
    } else if (plan_.scene_memory == SceneMemory::constant) {
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
    const Chains* const chains = chains_ == nullptr ? nullptr : chains_->numbers();
    pt::with_random_source(plan_, traits_, states_, chains, function);
  }

  const SceneTraits traits_;
  Scene scene_;  ///< a view of device memory
  CudaMemory memory_;
  std::uint64_t pool_size_ = 0;

 private:
  friend class CudaChains;  // another user of the launches and of trace_batch

  ChainDevice& chain_device() override { return *chains_; }
  void upload(const SceneData& scene);
  /// Whether the scene's arrays have the sizes of those on the device.
  bool has_same_sizes(const SceneData& scene);
  void allocate_film();
  void allocate_planes(std::uint64_t pixels);
  void load_kernels();
  void store_film(const Film& film) override;
  void begin_render(const Film* film) override;
  bool render_batch(const SampleBuffer& batch, RenderRun& run,
                    const std::function<bool()>& cancel) override;
  void end_render(RenderRun& run) override;
  void read_film(Film& film) override;
  template <class SomeFilm, class Function>
  void for_each_film_array(SomeFilm& film, Function&& function) const;
  void accumulate(const SampleBuffer& batch);
  /// Whether the image is nothing but the film's means, so that the device can make it.
  bool develops_here() const {
    return film_plan_.aovs == 0 && !film_plan_.two_signs && !has_chains();
  }
  void develop_into(float* rgb);
  PathTally read_tally() const;
  std::vector<LaneHistogram> read_lane_counts() const;

  std::string driver_;
  std::uint64_t primitive_count_;
  TreeFacts tree_facts_;  ///< of a tree built on the device
  std::vector<HalfSpheres> half_spheres_;
  std::vector<std::size_t> array_sizes_;  ///< in the order of for_each_array
  FilmView film_;  ///< of the film that is rendered, the first of the arrays' elements
  CudaDownload download_;
  PathTally* tally_ = nullptr;
  std::unique_ptr<CudaChains> chains_;  ///< only with --integrator mlt
  CurandState* states_ = nullptr;
  LaneCounts* lane_counts_ = nullptr;  ///< null: this build counts none
  double setup_ms_ = 0;
  double load_ms_ = 0;  ///< 0: not loaded yet
  double transfer_ms_ = 0;
};

}  // namespace pt
