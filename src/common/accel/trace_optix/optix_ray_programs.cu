// Rays of an array: a module for OptiX, compiled to PTX alone.
#include "common/accel/trace_optix/optix_intrinsics.cuh"
#include "common/accel/trace_optix/optix_programs.h"
#include "common/accel/trace_optix/optix_rays.h"

extern "C" {
__constant__ pt::OptixRayParams params;
}

PT_OPTIX_HIT_PROGRAMS(pt::optix::DeviceApi, pt::ClosestSurface, pt::AnySurface, params.scene)

#define PT_RAY_GENERATION(name)                                                \
  extern "C" __global__ void __raygen__closest_##name() {                      \
    pt::trace_closest_rays<pt::optix::DeviceApi, pt::OptixHits::name>(params); \
  }                                                                            \
  extern "C" __global__ void __raygen__any_##name() {                          \
    pt::trace_any_rays<pt::optix::DeviceApi, pt::OptixHits::name>(params);     \
  }

PT_RAY_GENERATION(custom)
PT_RAY_GENERATION(any_hit)
PT_RAY_GENERATION(built_in)
