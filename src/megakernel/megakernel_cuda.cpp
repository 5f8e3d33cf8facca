#include "megakernel/megakernel_cuda.h"

#include "megakernel/megakernel.h"

namespace pt {

MegakernelCuda::MegakernelCuda(const ExecutionPlan& plan, const SceneData& scene, int device)
    : CudaRenderer(plan, scene, device) {
  next_path_ = memory_.allocate<std::uint32_t>("counters", 1);
  if (plan_.megakernel == MegakernelKind::sort) {
    CudaLauncher& launcher = *this;
    blocks_ = std::make_unique<BlockWavefronts>(launcher, memory_, traits_, plan_.path_bytes);
  }
}

void MegakernelCuda::trace_batch(const SampleBuffer& batch) {
  check_cuda(cudaMemsetAsync(next_path_, 0, sizeof *next_path_, stream()), "cudaMemsetAsync");
  with_random_source([&](const auto& source) {
    using Source = std::remove_cvref_t<decltype(source)>;
    const SceneStorage<SceneMemory::global> in_global{scene_};
    if constexpr (std::is_same_v<Source, SamplerSource>) {
      if (plan_.megakernel == MegakernelKind::vote) return launch_phase_voting(source, batch);
      if (blocks_ != nullptr)
        return blocks_->trace(scene_, batch, source, path_settings_, StageId::megakernel);
      if (plan_.path_bytes > 0) return launch_carrying(source, batch);
      launch_megakernel(in_global, 0, source, batch);
    } else {
      if constexpr (std::is_same_v<Source, PhiloxSource>) {
        if (traits_.accel == Accel::brute) {
          return with_scene_storage([&](const auto& storage, std::size_t shared_bytes) {
            launch_megakernel(storage, shared_bytes, source, batch);
          });
        }
      }
      launch_megakernel(in_global, 0, source, batch);
    }
  });
}

std::unique_ptr<Renderer> make_megakernel_cuda(const ExecutionPlan& plan, const SceneData& scene,
                                               int device) {
  return std::make_unique<MegakernelCuda>(plan, scene, device);
}

}  // namespace pt
