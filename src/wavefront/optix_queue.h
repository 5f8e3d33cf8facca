// The rays of the wavefront's queues, traced by OptiX: what optix_queue_programs.cu is launched
// with.
#pragma once

#include "common/accel/trace_optix/optix_scene.h"
#include "wavefront/wave_buffers.h"

namespace pt {

struct OptixQueueParams {
  OptixScene scene;
  Scene world;  ///< for masks
  bool has_masks = false;
  PathPool pool;
  const std::uint32_t* slots = nullptr;  ///< the queue, *count of it
  const std::uint32_t* count = nullptr;
  SampleBuffer samples;
};

/// Masks need more of a ray than its query: the key (transport/mask.h).
template <class Query>
class KeyedQuery : public Query {
 public:
  PT_HD KeyedQuery(float t_min, float t_max, std::uint32_t key = 0)
      : Query(t_min, t_max), key_(key) {}
  PT_HD std::uint32_t key() const { return key_; }

 private:
  std::uint32_t key_;
};

/// Any scene without masks has MaskedTraits' path hashes, and never asks for them.
using OptixMaskTraits = Traits<Accel::cwbvh, Geometry::mixed, Lighting::sky, true>;

/// The next ray of the path in the slot: trace(ray, query) gives its hit.
template <class Query, class Trace>
PT_HD void trace_queued_path(const OptixQueueParams& p, std::uint32_t slot, Trace&& trace) {
  const Ray ray = p.pool.load_ray(slot);
  float t_max = infinite_distance;
  std::uint32_t key = 0;
  if (p.has_masks) {
    const PathState path = p.pool.load_path_id(slot);
    key = next_ray_key(p.world, path_hash<OptixMaskTraits>(p.world, p.samples.id_of(path.index)),
                       path.rays);
    t_max = ray_length(p.world, ray.direction, key);
  }
  p.pool.store_hit(slot, trace(ray, Query(0.0f, t_max, key)));
}

/// Its shadow ray: trace(ray, query) says whether it is occluded.
template <class Query, class Trace>
PT_HD void trace_queued_shadow_ray(const OptixQueueParams& p, std::uint32_t slot, Trace&& trace) {
  std::uint32_t path_index, key = 0;
  const ShadowRay shadow = p.pool.load_shadow(slot, path_index);
  if (p.has_masks) {
    key = shadow_ray_key(p.world, path_hash<OptixMaskTraits>(p.world, p.samples.id_of(path_index)),
                         p.pool.load_shadow_rays(slot));
  }
  if (!trace(shadow.ray, Query(0.0f, shadow.distance, key)))
    add_radiance(p.samples, path_index, shadow.radiance);
}

}  // namespace pt
