// The queues of the wavefront: a module for OptiX, compiled to PTX alone.
#include "common/accel/trace_optix/optix_programs.cuh"
#include "common/accel/trace_optix/optix_rays.h"
#include "wavefront/optix_queue.h"

extern "C" {
__constant__ pt::OptixQueueParams params;
}

namespace pt {

/// Asks the scene's masks; scenes with instances have none.
template <class Query>
struct JudgingQuery : KeyedQuery<Query> {
  static constexpr bool has_masks = true;
  using KeyedQuery<Query>::KeyedQuery;

  __device__ __forceinline__ bool hides(const Triangle& triangle, const TriangleHit& hit, float t,
                                        std::uint32_t) const {
    return is_up_to_mask(*this, triangle, t) &&
           passes_mask(MaskView(params.world), this->key(), triangle, hit.b1, hit.b2,
                       [] { return 0u; });
  }
};

using ClosestQuery = JudgingQuery<ClosestTriangle>;
using AnyQuery = JudgingQuery<AnyTriangle>;

template <OptixHits hits>
__device__ __forceinline__ void trace_paths() {
  const std::uint32_t count = *params.count;
  for (std::uint32_t i = optix::launch_index(); i < count; i += optix::launch_width()) {
    trace_queued_path<ClosestQuery>(params, params.slots[i],
                                    [](const Ray& ray, const ClosestQuery& query) {
                                      return optix::trace_closest<hits>(params.scene, ray, query);
                                    });
  }
}

template <OptixHits hits>
__device__ __forceinline__ void trace_shadow_rays() {
  const std::uint32_t count = *params.count;
  for (std::uint32_t i = optix::launch_index(); i < count; i += optix::launch_width()) {
    trace_queued_shadow_ray<AnyQuery>(params, params.slots[i],
                                      [](const Ray& ray, const AnyQuery& query) {
                                        return optix::trace_any<hits>(params.scene, ray, query);
                                      });
  }
}

}  // namespace pt

PT_OPTIX_HIT_PROGRAMS(pt::ClosestQuery, pt::AnyQuery)

#define PT_RAY_GENERATION(name)                           \
  extern "C" __global__ void __raygen__closest_##name() { \
    pt::trace_paths<pt::OptixHits::name>();               \
  }                                                       \
  extern "C" __global__ void __raygen__any_##name() {     \
    pt::trace_shadow_rays<pt::OptixHits::name>();         \
  }

PT_RAY_GENERATION(custom)
PT_RAY_GENERATION(any_hit)
PT_RAY_GENERATION(built_in)
