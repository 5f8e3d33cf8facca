// The megakernel's renderer. The loop has 15 variants (scene, branching, random numbers, scene
// memory), so launching is split into files that compile side by side; the kernels that vote and
// sort are one each.
#pragma once

#include "common/device/cuda/cuda_renderer.cuh"

namespace pt {

struct PathSlot;

class MegakernelCuda : public CudaRenderer {
 public:
  MegakernelCuda(const Options& options, const SceneData& scene, int device);

  /// Launches the kernel for this storage of the scene and this source of random numbers.
  template <SceneMemory memory, class Source>
  void launch_megakernel(const SceneStorage<memory>& storage, std::size_t shared_bytes,
                         const Source& source, const SampleBuffer& batch);

 protected:
  /// A branch in each thread on whether paths repeat cost all renders 4 to 11 % (results/).
  bool can_repeat_paths() const override { return false; }
  void trace_batch(const SampleBuffer& batch) override;

 private:
  template <class Kernel>
  dim3 grid_size(Kernel kernel, dim3 block, std::size_t shared_bytes, const SampleBuffer& batch);

  /// How many paths a block that sorts has for each thread: what its shared memory has room for.
  int block_wavefront_slots() const;
  void launch_phase_voting(const SamplerSource& source, const SampleBuffer& batch);
  template <bool has_masks>
  std::uint32_t block_wavefront_blocks();
  template <bool has_masks>
  void allocate_slots();
  template <bool has_masks>
  void launch_block_wavefront(const SamplerSource& source, const SampleBuffer& batch);

  std::uint32_t* next_path_ = nullptr;
  PathSlot* slots_ = nullptr;  ///< only where blocks sort
};

}  // namespace pt
