#include "wavefront/run_block_cpu.h"

#include "common/transport/mask.h"
#include "wavefront/run_stage_cpu.h"

namespace pt {
namespace {

using Slots = std::array<std::uint32_t, RayBlock::size_max>;

// Traces the next rays of the paths in `count` slots; `send(slot, next)` takes each on.
template <class Send>
void run_block(const PathRays& stage, const BlockTraits& traits, const SampleBuffer& samples,
               const Scene& scene, const Slots& slots, std::uint32_t count, Send&& send) {
  RayBlock rays;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Ray ray = stage.pool.load_ray(slots[i]);
    float length = infinite_distance;
    std::uint32_t key = 0;
    if (traits.has_masks) {
      const PathState path = stage.pool.load_path_id(slots[i]);
      key = next_ray_key(scene, path_hash<MaskedRays>(scene, samples.id_of(path.index)), path.rays);
      length = ray_length(scene, ray.direction, key);
    }
    rays.append(ray, length, key);
  }
  std::array<Hit, RayBlock::size_max> hits;
  intersect_closest_block(traits, scene, rays, hits.data());
  for (std::uint32_t i = 0; i < count; ++i) {
    if (traits.has_media && stage.pool.is_in_medium(slots[i])) {
      stage.pool.store_hit(slots[i], hits[i]);
      send(slots[i], Next{StageId::sample_medium});
    } else {
      send(slots[i], stage.finish(slots[i], hits[i]));
    }
  }
}

// Likewise the shadow rays.
template <class Send>
void run_block(const ShadowRays& stage, const BlockTraits& traits, const SampleBuffer& samples,
               const Scene& scene, const Slots& slots, std::uint32_t count, Send&& send) {
  RayBlock rays;
  std::uint32_t path_index;
  for (std::uint32_t i = 0; i < count; ++i) {
    const ShadowRay shadow = stage.pool.load_shadow(slots[i], path_index);
    std::uint32_t key = 0;
    if (traits.has_masks) {
      key = shadow_ray_key(scene, path_hash<MaskedRays>(scene, samples.id_of(path_index)),
                           stage.pool.load_shadow_rays(slots[i]));
    }
    rays.append(shadow.ray, shadow.distance, key);
  }
  const std::uint32_t occluded = intersect_shadow_block(traits, scene, rays);
  for (std::uint32_t i = 0; i < count; ++i) {
    const bool is_occluded = (occluded >> i & 1u) != 0;
    if (traits.has_media && !is_occluded)
      AttenuateShadowRays{stage.pool, samples}(scene, slots[i], i);
    const ShadowRay shadow = stage.pool.load_shadow(slots[i], path_index);
    send(slots[i], stage.finish(path_index, shadow, is_occluded));
  }
}

template <class Stage>
void run_blocks(const Stage& stage, const BlockTraits& traits, const SampleBuffer& samples,
                const Scene& scene, const StageQueues& queues) {
  for_each_range<Stage>(queues, [&](std::uint32_t begin, std::uint32_t end, auto&& send) {
    for_each_block<Stage, RayBlock::size_max>(
        queues, begin, end, [&](const Slots& slots, std::uint32_t count) {
          run_block(stage, traits, samples, scene, slots, count, send);
        });
  });
}

}  // namespace

void run_blocks_cpu(const PathRays& stage, const BlockTraits& traits, const SampleBuffer& samples,
                    const Scene& scene, const StageQueues& queues) {
  run_blocks(stage, traits, samples, scene, queues);
}

void run_blocks_cpu(const ShadowRays& stage, const BlockTraits& traits, const SampleBuffer& samples,
                    const Scene& scene, const StageQueues& queues) {
  run_blocks(stage, traits, samples, scene, queues);
}

}  // namespace pt
