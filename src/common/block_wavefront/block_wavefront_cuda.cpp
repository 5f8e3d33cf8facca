#include "common/block_wavefront/block_wavefront_cuda.h"

namespace pt {
namespace {

/// Scenes with masks or media are `mixed`, too; here they have no instances. So are those that
/// move.
BlockWavefrontCode code_for(const SceneTraits& traits, bool has_instances, int path_bytes) {
  if (path_bytes > 0) return code_that_carries();
  if (traits.has_motion)
    return has_instances ? code_for_moving_instances() : code_for_moving_cameras();
  if (traits.has_media) return code_for_media();
  if (traits.has_masks) return code_for_masks();
  return traits.geometry == Geometry::mixed ? code_for_instances() : code_for_triangles();
}

}  // namespace

BlockWavefronts::BlockWavefronts(CudaLauncher& launcher, CudaMemory& memory,
                                 const SceneTraits& traits, bool has_instances, int path_bytes,
                                 std::uint32_t paths_max)
    : launcher_(launcher), code_(code_for(traits, has_instances, path_bytes)) {
  const std::size_t room = launcher_.properties_.sharedMemPerBlockOptin;
  while (slots_per_thread_ > block_wavefront_slots_least && code_.bytes(slots_per_thread_) > room)
    --slots_per_thread_;
  blocks_ = launcher_.resident_blocks(reinterpret_cast<const void*>(code_.kernel),
                                      block_wavefront_threads, code_.bytes(slots_per_thread_));
  const auto fits = [&](int slots) {
    return std::uint64_t{blocks_} * block_wavefront_threads * slots >= paths_max;
  };
  while (slots_per_thread_ > 1 && fits(slots_per_thread_ - 1)) --slots_per_thread_;
  slots_.per_block = static_cast<std::uint32_t>(block_wavefront_threads * slots_per_thread_);
  slots_.paths = memory.allocate<PathSlot>("paths", capacity());
  if (traits.has_media) slots_.media = memory.allocate<PathRecord>("paths", capacity());
  if (path_bytes > 0) {
    const auto records = static_cast<std::uint32_t>(path_bytes / extra_record_bytes);
    const std::uint64_t all = std::uint64_t{capacity()} * records;
    slots_.extra = ExtraState::by_place(memory.allocate<ExtraRecord>("paths", all), records);
  }
  next_path_ = memory.allocate<std::uint32_t>("counters", 1);
}

void BlockWavefronts::trace(const Scene& scene, const SampleBuffer& batch,
                            const SamplerSource& source, const PathSettings& settings,
                            StageId stage) {
  check_cuda(cudaMemsetAsync(next_path_, 0, sizeof *next_path_, launcher_.stream()),
             "cudaMemsetAsync");
  const std::uint32_t at_once = (batch.path_count + blocks_ - 1) / blocks_;
  launch(scene, batch, source, settings, stage, at_once, place(0));
}

void BlockWavefronts::finish(const Scene& scene, const SampleBuffer& batch,
                             const SamplerSource& source, const PathSettings& settings,
                             StageId stage, const BegunPaths& paths) {
  launch(scene, batch, source, settings, stage, 0, paths);
}

void BlockWavefronts::launch(const Scene& scene, const SampleBuffer& batch,
                             const SamplerSource& source, const PathSettings& settings,
                             StageId stage, std::uint32_t at_once, const BegunPaths& begun) {
  const PathShare paths{next_path_, at_once, slots_per_thread_};
  launcher_.launch(to_string(stage).c_str(), code_.kernel, blocks_, block_wavefront_threads,
                   code_.bytes(slots_per_thread_), scene, batch, source, settings, paths, begun,
                   stage, launcher_.clock());
}

}  // namespace pt
