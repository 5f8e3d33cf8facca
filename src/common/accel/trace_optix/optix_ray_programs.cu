// Rays of an array: a module for OptiX, compiled to PTX alone.
#include "common/accel/trace_optix/optix_programs.cuh"
#include "common/accel/trace_optix/optix_rays.h"

extern "C" {
__constant__ pt::OptixRayParams params;
}

PT_OPTIX_HIT_PROGRAMS(pt::ClosestTriangle, pt::AnyTriangle)

namespace pt {

template <OptixHits hits>
__device__ __forceinline__ void trace_closest_rays() {
  for (std::uint32_t i = optix::launch_index(); i < params.rays.count; i += optix::launch_width()) {
    const RayRecord ray = load_wide(&params.rays.rays[i]);
    const Hit hit =
        optix::trace_closest<hits>(params.scene, ray.ray(), ClosestTriangle(ray.t_min, ray.t_max));
    params.rays.hits[i] = hit.is_miss()
                              ? HitRecord{-1.0f, no_primitive}
                              : HitRecord{hit.t, params.scene.tree.triangles[hit.primitive].id};
  }
}

template <OptixHits hits>
__device__ __forceinline__ void trace_any_rays() {
  for (std::uint32_t i = optix::launch_index(); i < params.rays.count; i += optix::launch_width()) {
    const RayRecord ray = load_wide(&params.rays.rays[i]);
    const bool met =
        optix::trace_any<hits>(params.scene, ray.ray(), AnyTriangle(ray.t_min, ray.t_max));
    params.rays.hits[i] = {met ? 0.0f : -1.0f, no_primitive};
  }
}

}  // namespace pt

#define PT_RAY_GENERATION(name)                           \
  extern "C" __global__ void __raygen__closest_##name() { \
    pt::trace_closest_rays<pt::OptixHits::name>();        \
  }                                                       \
  extern "C" __global__ void __raygen__any_##name() { pt::trace_any_rays<pt::OptixHits::name>(); }

PT_RAY_GENERATION(custom)
PT_RAY_GENERATION(any_hit)
PT_RAY_GENERATION(built_in)
