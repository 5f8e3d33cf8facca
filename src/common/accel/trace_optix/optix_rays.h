// Arrays of rays traced by OptiX.
#pragma once

#include <string>

#include "common/accel/ray_record.h"
#include "common/accel/trace_optix/optix_programs.h"

namespace pt {

/// optix_ray_programs.cu in PTX; empty where ptexp was built without it.
const std::string& optix_ray_code();

/// The launch parameters of optix_ray_programs.cu.
struct OptixRayParams {
  OptixScene scene;
  RayArrays rays;
};

/// Ray generation.
template <class Api, OptixHits hits>
PT_OPTIX_FUNCTION void trace_closest_rays(const OptixRayParams& p) {
  for (std::uint32_t i = Api::launch_index(); i < p.rays.count; i += Api::launch_width()) {
    const RayRecord ray = load_wide(&p.rays.rays[i]);
    const Hit hit =
        optix::trace_closest<Api, hits>(p.scene, ray.ray(), ClosestSurface(ray.t_min, ray.t_max));
    const std::uint32_t spheres = p.scene.primitives.count();
    HitRecord record{-1.0f, no_primitive};
    if (!hit.is_miss()) record = {hit.t, hit.primitive};
    if (!hit.is_miss() && hit.primitive >= spheres)
      record.primitive = spheres + p.scene.tree.triangles[hit.primitive - spheres].id;
    p.rays.hits[i] = record;
  }
}

template <class Api, OptixHits hits>
PT_OPTIX_FUNCTION void trace_any_rays(const OptixRayParams& p) {
  for (std::uint32_t i = Api::launch_index(); i < p.rays.count; i += Api::launch_width()) {
    const RayRecord ray = load_wide(&p.rays.rays[i]);
    const bool met =
        optix::trace_any<Api, hits>(p.scene, ray.ray(), AnySurface(ray.t_min, ray.t_max));
    p.rays.hits[i] = {met ? 0.0f : -1.0f, no_primitive};
  }
}

}  // namespace pt
