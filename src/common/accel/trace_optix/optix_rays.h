// Arrays of rays traced by OptiX.
#pragma once

#include "common/accel/ray_record.h"
#include "common/accel/trace_optix/optix_scene.h"

namespace pt {

/// The launch parameters of optix_ray_programs.cu.
struct OptixRayParams {
  OptixScene scene;
  RayArrays rays;
};

/// Threads of a launch, at most; each takes every so many rays.
inline constexpr std::uint32_t optix_width_max = 1u << 20;

}  // namespace pt
