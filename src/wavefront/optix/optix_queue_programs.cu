// The queues of the wavefront: a module for OptiX, compiled to PTX alone.
#include "common/accel/trace_optix/optix_intrinsics.cuh"
#include "wavefront/optix/optix_queue.h"

/// Memory without a constructor, which a variable in constant memory cannot have.
union OptixQueueMemory {
  char none;
  pt::OptixQueueParams queue;
  constexpr __host__ __device__ OptixQueueMemory() : none(0) {}
};

extern "C" {
__constant__ OptixQueueMemory params;
}

namespace pt {

struct QueueApi : optix::DeviceApi {
  static __device__ __forceinline__ const Scene& world() { return params.queue.world; }
  static __device__ __forceinline__ MaskView masks() { return MaskView(world()); }
};

}  // namespace pt

PT_OPTIX_HIT_PROGRAMS(pt::QueueApi, pt::ClosestJudge<pt::QueueApi>, pt::AnyJudge<pt::QueueApi>,
                      params.queue.scene)

#define PT_RAY_GENERATION(name)                                                    \
  extern "C" __global__ void __raygen__closest_##name() {                          \
    pt::trace_queued_paths<pt::QueueApi, pt::OptixHits::name>(params.queue);       \
  }                                                                                \
  extern "C" __global__ void __raygen__any_##name() {                              \
    pt::trace_queued_shadow_rays<pt::QueueApi, pt::OptixHits::name>(params.queue); \
  }

PT_RAY_GENERATION(custom)
PT_RAY_GENERATION(any_hit)
PT_RAY_GENERATION(built_in)
