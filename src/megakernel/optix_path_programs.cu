// The megakernel as a module for OptiX, compiled to PTX alone: no host runs what calls OptiX.
#pragma nv_diag_suppress 20011, 20014
#include "common/accel/trace_optix/optix_intrinsics.cuh"
#include "megakernel/optix_paths.h"

/// Memory without a constructor, which a variable in constant memory cannot have.
union OptixPathMemory {
  char none;
  pt::OptixPathParams paths;
  constexpr __host__ __device__ OptixPathMemory() : none(0) {}
};

extern "C" {
__constant__ OptixPathMemory params;
}

namespace pt {

struct PathApi : optix::DeviceApi {
  static __device__ __forceinline__ const OptixPathParams& params() { return ::params.paths; }
  static __device__ __forceinline__ const Scene& world() { return ::params.paths.world; }
  static __device__ __forceinline__ MaskView masks() { return MaskView(world()); }
};

}  // namespace pt

PT_OPTIX_HIT_PROGRAMS(pt::PathApi, pt::ClosestJudge<pt::PathApi>, pt::AnyJudge<pt::PathApi>,
                      params.paths.scene)

extern "C" __global__ void __raygen__paths() { pt::trace_launched_paths<pt::PathApi>(); }
