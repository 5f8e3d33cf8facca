// Block-local wavefronts on a GPU (block_wavefront.cuh): the memory of their paths, and launches.
#pragma once

#include "common/block_wavefront/path_share.h"
#include "common/cuda/cuda_memory.cuh"
#include "common/device/cuda/cuda_launcher.cuh"
#include "common/film/film.h"
#include "common/render/settings_of.h"

namespace pt {

/// All that a multiprocessor has room for at 96 registers: so they share the code that is in its
/// instruction cache, and their paths are sorted together (results/ has the measurement).
inline constexpr int block_wavefront_threads = 640;
inline constexpr int block_wavefront_slots_least = 4, block_wavefront_slots_most = 12;

/// See block_wavefront_kernel.cuh.
using BlockWavefrontKernel = void (*)(Scene, SampleBuffer, SamplerSource, PathSettings, PathShare,
                                      BegunPaths, StageId, StageClock*);

/// The kernel of one kind of scenes.
struct BlockWavefrontCode {
  BlockWavefrontKernel kernel;
  std::size_t (*bytes)(int slots_per_thread);  ///< of a block's shared memory
};
BlockWavefrontCode code_for_triangles();
BlockWavefrontCode code_for_masks();
BlockWavefrontCode code_for_media();
BlockWavefrontCode code_for_instances();
BlockWavefrontCode code_for_moving_instances();
BlockWavefrontCode code_for_moving_cameras();
/// For triangles whose paths carry extra records, if the build has it (plan/kernels.h).
BlockWavefrontCode code_that_carries();

/// For scenes of triangles in a wide tree, without boundaries that have no BSDF; or of instances of
/// triangles as well, without masks and media, which may move, as may the camera.
class BlockWavefronts {
 public:
  /// Takes memory for as many paths as blocks have room for, or for `paths_max` of them.
  BlockWavefronts(CudaLauncher& launcher, CudaMemory& memory, const SceneTraits& traits,
                  bool has_instances, int path_bytes, std::uint32_t paths_max = ~0u);

  /// Paths that place() has room for.
  std::uint32_t capacity() const { return blocks_ * slots_.per_block; }

  /// Enqueues a kernel that takes all paths of a batch from their first rays to their ends, and
  /// counts as `stage`.
  void trace(const Scene& scene, const SampleBuffer& batch, const SamplerSource& source,
             const PathSettings& settings, StageId stage);

  /// Where `count` paths are to be put for finish().
  BegunPaths place(std::uint32_t count) const { return BegunPaths::divide(slots_, count, blocks_); }
  /// The same as trace() for paths that have begun.
  void finish(const Scene& scene, const SampleBuffer& batch, const SamplerSource& source,
              const PathSettings& settings, StageId stage, const BegunPaths& paths);

 private:
  void launch(const Scene& scene, const SampleBuffer& batch, const SamplerSource& source,
              const PathSettings& settings, StageId stage, std::uint32_t at_once,
              const BegunPaths& begun);

  CudaLauncher& launcher_;
  const BlockWavefrontCode code_;
  int slots_per_thread_ = block_wavefront_slots_most;
  std::uint32_t blocks_ = 0;
  BlockSlots slots_{};
  std::uint32_t* next_path_ = nullptr;
};

}  // namespace pt
