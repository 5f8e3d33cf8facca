// The rays of the wavefront's queues, traced by OptiX: what optix_queue_programs.cu is launched
// with.
#pragma once

#include "common/accel/trace_optix/optix_pipeline.h"
#include "common/accel/trace_optix/optix_programs.h"
#include "common/scene/data/scene.h"
#include "common/transport/mask.h"
#include "wavefront/pool/path_pool.h"

namespace pt {

class OptixTracer;

struct OptixQueueParams {
  OptixScene scene{};
  Scene world;  ///< for masks
  bool has_masks = false;
  PathPool pool;
  const std::uint32_t* slots = nullptr;  ///< the queue, *count of it
  const std::uint32_t* count = nullptr;
  SampleBuffer samples;
};

/// optix_queue_programs.cu.
OptixModule optix_queue_module();

/// Enqueues a launch over a queue: the next hit of each path is stored (OptixPipeline::closest), or
/// light that arrives is added (any). The tracer fills in `params.scene`.
void trace_by_optix(OptixTracer& tracer, OptixPipeline::Launch kind, OptixQueueParams params);

/// Any scene without masks has MaskedTraits' path hashes, and never asks for them.
using OptixMaskTraits = Traits<Accel::cwbvh, Geometry::mixed, Lighting::sky, true>;

/// The next ray of the path in the slot.
template <class Api, OptixHits hits>
PT_OPTIX_FUNCTION void trace_queued_path(const OptixQueueParams& p, std::uint32_t slot) {
  const Ray ray = p.pool.load_ray(slot);
  float t_max = infinite_distance;
  std::uint32_t key = 0;
  if (p.has_masks) {
    const PathState path = p.pool.load_path_id(slot);
    key = next_ray_key(p.world, path_hash<OptixMaskTraits>(p.world, p.samples.id_of(path.index)),
                       path.rays);
    t_max = ray_length(p.world, ray.direction, key);
  }
  p.pool.store_hit(
      slot, optix::trace_closest<Api, hits>(p.scene, ray, ClosestJudge<Api>(0.0f, t_max, key)));
}

template <class Api, OptixHits hits>
PT_OPTIX_FUNCTION void trace_queued_shadow_ray(const OptixQueueParams& p, std::uint32_t slot) {
  std::uint32_t path_index, key = 0;
  const ShadowRay shadow = p.pool.load_shadow(slot, path_index);
  if (p.has_masks) {
    key = shadow_ray_key(p.world, path_hash<OptixMaskTraits>(p.world, p.samples.id_of(path_index)),
                         p.pool.load_shadow_rays(slot));
  }
  const AnyJudge<Api> query(0.0f, shadow.distance, key);
  if (!optix::trace_any<Api, hits>(p.scene, shadow.ray, query))
    add_radiance(p.samples, path_index, shadow.radiance);
}

// Ray generation.

template <class Api, OptixHits hits>
PT_OPTIX_FUNCTION void trace_queued_paths(const OptixQueueParams& p) {
  const std::uint32_t count = *p.count;
  for (std::uint32_t i = Api::launch_index(); i < count; i += Api::launch_width())
    trace_queued_path<Api, hits>(p, p.slots[i]);
}

template <class Api, OptixHits hits>
PT_OPTIX_FUNCTION void trace_queued_shadow_rays(const OptixQueueParams& p) {
  const std::uint32_t count = *p.count;
  for (std::uint32_t i = Api::launch_index(); i < count; i += Api::launch_width())
    trace_queued_shadow_ray<Api, hits>(p, p.slots[i]);
}

}  // namespace pt
