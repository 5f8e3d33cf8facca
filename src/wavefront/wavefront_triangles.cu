// Scenes with triangles.
#include "wavefront/trace_queue.cuh"
#include "wavefront/wavefront_enqueue.cuh"

namespace pt {

template <class Rays>
void WavefrontCuda::trace_persistently(const Rays& rays, const SampleBuffer& samples,
                                       StageId stage) {
  using Masked = MaskedRays<Rays>;
  if (has_masks_) {
    run_persistent<CwbvhLane<typename Masked::Query>>(Masked{{rays, scene_, samples}}, stage);
  } else if (scene_.triangles.instance_count > 0 && traits_.has_motion) {
    using Moving = MovingRays<Rays>;
    run_persistent<InstancedLane<typename Moving::Query>>(Moving{{rays, scene_, samples}}, stage);
  } else if (scene_.triangles.instance_count > 0) {
    run_persistent<InstancedLane<typename Rays::Query>>(rays, stage);
  } else {
    run_persistent<CwbvhLane<typename Rays::Query>>(rays, stage);
  }
}

template <class Lane, class Rays>
void WavefrontCuda::run_persistent(const Rays& rays, StageId stage) {
  constexpr auto kernel = trace_rays_of_queue<Lane, Rays>;
  const std::uint32_t blocks =
      resident_blocks(reinterpret_cast<const void*>(kernel), persistent_block<Lane>, 0);
  launch(stage_info(stage).name.data(), kernel, blocks, persistent_block<Lane>, 0, scene_.triangles,
         rays, stage, clock());
}

void WavefrontCuda::trace_queue(const StageQueues& queues, const SampleBuffer& samples) {
  if (optix_ != nullptr) return trace_by_optix(StageId::intersect, queues, samples);
  QueuedPaths paths{{buffers_.pool, queues, &buffers_.counters->traced}};
  set_lanes(paths.rays, lanes_of(scene_));
  trace_persistently(paths, samples, StageId::intersect);
}

void WavefrontCuda::trace_shadow_queue(const StageQueues& queues, const SampleBuffer& samples) {
  if (optix_ != nullptr) return trace_by_optix(StageId::shadow, queues, samples);
  QueuedShadowRays shadows{{buffers_.pool, queues, &buffers_.counters->shadow_traced}, samples};
  set_lanes(shadows.rays, lanes_of(scene_));
  trace_persistently(shadows, samples, StageId::shadow);
}

using SamplerContext = StageContext<SamplerSource>;

template void WavefrontCuda::enqueue_wave_of<WaveKinds<SamplerSource>>(const SamplerContext&, bool);
template void WavefrontCuda::enqueue_finish_of<WaveKinds<SamplerSource>>(const SamplerContext&);

// With --path-bytes; of no scene in a build without.
using CarryingContext = StageContext<CarryingSource<>>;
using CarryingKinds = WaveKinds<CarryingSource<>>;

template void WavefrontCuda::enqueue_wave_of<CarryingKinds>(const CarryingContext&, bool);
template void WavefrontCuda::enqueue_finish_of<CarryingKinds>(const CarryingContext&);

}  // namespace pt
