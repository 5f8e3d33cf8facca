// The megakernel's renderer. Its kernel has 37 variants (scene, branching, random numbers, scene
// memory), so launching is split into files that compile side by side.
#pragma once

#include "common/device/cuda_renderer.cuh"

namespace pt {

class MegakernelCuda : public CudaRenderer {
 public:
  MegakernelCuda(const Options& options, const SceneData& scene, int device);

  /// Launches the kernel for this storage of the scene and this source of random numbers.
  template <SceneMemory memory, class Source>
  void launch_megakernel(const SceneStorage<memory>& storage, std::size_t shared_bytes,
                         const Source& source, const SampleBuffer& batch);

 protected:
  void trace_batch(const SampleBuffer& batch) override;

 private:
  template <class Kernel>
  dim3 grid_size(Kernel kernel, dim3 block, std::size_t shared_bytes, const SampleBuffer& batch);

  std::uint32_t* next_path_ = nullptr;
};

}  // namespace pt
