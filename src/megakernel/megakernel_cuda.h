// The megakernel's renderer. The loop has many variants (scene, branching, random numbers, scene
// memory, path bytes), so launching is split into files that compile side by side; the kernel that
// votes is one, and so is that of the block-local wavefront.
#pragma once

#include "common/block_wavefront/block_wavefront_cuda.h"
#include "common/device/cuda/cuda_renderer.cuh"

namespace pt {

class CudaOptixMemory;
class OptixTracer;

class MegakernelCuda : public CudaRenderer {
 public:
  MegakernelCuda(const ExecutionPlan& plan, const SceneData& scene, int device);
  ~MegakernelCuda() override;
  bool set_scene(const SceneData& scene, const SceneChanges& changes) override;

  /// Launches the kernel for this storage of the scene and this source of random numbers.
  template <SceneMemory memory, class Source>
  void launch_megakernel(const SceneStorage<memory>& storage, std::size_t shared_bytes,
                         const Source& source, const SampleBuffer& batch);

 protected:
  /// A branch in each thread on whether paths repeat cost all renders 4 to 11 % (results/).
  bool can_repeat_paths() const override { return false; }
  void trace_batch(const SampleBuffer& batch) override;
  void describe(RenderReport& report) const override;

 private:
  /// Builds what OptiX needs, where it runs the megakernel.
  void make_optix();
  void launch_by_optix(const SamplerSource& source, const SampleBuffer& batch);
  template <class Kernel>
  dim3 grid_size(Kernel kernel, dim3 block, std::size_t shared_bytes, const SampleBuffer& batch);

  void launch_phase_voting(const SamplerSource& source, const SampleBuffer& batch);
  template <bool carries>
  void launch_phase_voting_of(const SamplerSource& source, const SampleBuffer& batch);
  /// launch_megakernel for paths that carry extra records (--path-bytes).
  void launch_carrying(const SamplerSource& source, const SampleBuffer& batch);

  std::uint32_t* next_path_ = nullptr;
  std::unique_ptr<BlockWavefronts> blocks_;  ///< only with --kernel sort
  std::unique_ptr<CudaOptixMemory> optix_memory_;
  std::unique_ptr<OptixTracer> optix_;  ///< only with --accel optix
};

}  // namespace pt
