#include "megakernel/megakernel_cuda.h"

#include "common/accel/trace_optix/optix_memory_cuda.h"
#include "common/accel/trace_optix/optix_tracer.h"
#include "megakernel/megakernel.h"
#include "megakernel/optix_paths.h"

namespace pt {

MegakernelCuda::MegakernelCuda(const ExecutionPlan& plan, const SceneData& scene, int device)
    : CudaRenderer(plan, scene, device) {
  next_path_ = memory_.allocate<std::uint32_t>("counters", 1);
  if (plan_.megakernel == MegakernelKind::sort) {
    CudaLauncher& launcher = *this;
    blocks_ = std::make_unique<BlockWavefronts>(
        launcher, memory_, traits_, scene_.triangles.instance_count > 0, plan_.path_bytes);
  }
  make_optix();
}

MegakernelCuda::~MegakernelCuda() = default;

void MegakernelCuda::make_optix() {
  optix_.reset();  // its memory is needed
  if (!plan_.traces_by_optix) return;
  const OptixPathChoices choices{plan_.optix_hits, plan_.reorder};
  optix_memory_ = std::make_unique<CudaOptixMemory>(stream());
  optix_ = std::make_unique<OptixTracer>(*optix_memory_, scene_, plan_.optix_hits,
                                         optix_path_module(choices));
}

bool MegakernelCuda::set_scene(const SceneData& scene, const SceneChanges& changes) {
  if (!CudaRenderer::set_scene(scene, changes)) return false;
  if (changes.move_surfaces()) make_optix();
  return true;
}

void MegakernelCuda::describe(RenderReport& report) const {
  CudaRenderer::describe(report);
  if (optix_ != nullptr) optix_->describe(report, plan_.reorder);
}

void MegakernelCuda::launch_by_optix(const SamplerSource& source, const SampleBuffer& batch) {
  enqueue_stamp(StageId::megakernel);
  launch_paths(*optix_, plan_.work,
               {.choices = {plan_.optix_hits, plan_.reorder},
                .world = scene_,
                .source = source,
                .samples = batch,
                .settings = path_settings_});
}

void MegakernelCuda::trace_batch(const SampleBuffer& batch) {
  check_cuda(cudaMemsetAsync(next_path_, 0, sizeof *next_path_, stream()), "cudaMemsetAsync");
  with_random_source([&](const auto& source) {
    using Source = std::remove_cvref_t<decltype(source)>;
    const SceneStorage<SceneMemory::global> in_global{scene_};
    if constexpr (std::is_same_v<Source, SamplerSource>) {
      if (optix_ != nullptr) return launch_by_optix(source, batch);
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
