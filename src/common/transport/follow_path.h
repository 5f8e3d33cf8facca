// A path from a ray to its end: what one thread does that follows it alone.
#pragma once

#include "common/sampling/random.h"
#include "common/transport/shade_any.h"

namespace pt {

/// The integrator's surface() with the random numbers that decide this ray of the path; shade_any
/// where the hit may be a miss.
template <class Traits, bool may_miss = false, class Stream>
PT_HD Scattering scatter_path(const Scene& scene, const Ray& ray, const Hit& hit, PathState& path,
                              const PathLimits& limits, Stream& random) {
  const Vec4 u = random.draw(scatter_block(path.rays));
  const Vec4 light = Traits::has_lights ? random.draw(light_block(path.rays)) : Vec4(0.0f);
  if constexpr (may_miss) return shade_any<Traits>(scene, ray, hit, path, limits, u, light);
  return Traits::Integrator::template surface<Traits>(scene, ray, hit, path, limits, u, light);
}

/// Traces one ray of a path, shades what it meets, and adds to the path's radiance. Returns whether
/// the path goes on: `ray` is then its next one. `path_key` is mask_key().
template <class Traits, class Stream>
PT_HD bool follow_ray(const Scene& scene, Ray& ray, PathState& path, Color& radiance,
                      const PathLimits& limits, Stream& random, std::uint32_t path_key) {
  const Hit hit = intersect_closest<Traits>(scene, ray, next_ray_key(scene, path_key, path.rays));
  ++path.rays;
  if (hit.is_miss()) {
    radiance = add_rounded(radiance, Traits::Integrator::template miss<Traits::lighting>(
                                         scene, ray.direction, path, limits));
    return false;
  }
  const Scattering scattering = scatter_path<Traits>(scene, ray, hit, path, limits, random);
  radiance = add_rounded(radiance, scattering.emitted);
  if (Traits::has_lights && !is_black(scattering.shadow.radiance) &&
      !intersect_shadow<Traits>(scene, scattering.shadow,
                                shadow_ray_key(scene, path_key, path.rays))) {
    radiance = add_rounded(radiance, scattering.shadow.radiance);
  }
  ray = scattering.ray;
  return scattering.alive;
}

/// Traces `ray` and what follows it. Returns the path's radiance: `radiance`, which it brings
/// along, and all that is added.
template <class Traits, class Stream>
PT_HD Color follow_path(const Scene& scene, Ray ray, PathState& path, Color radiance,
                        const PathLimits& limits, Stream& random, std::uint32_t path_key) {
  while (follow_ray<Traits>(scene, ray, path, radiance, limits, random, path_key)) {
  }
  return radiance;
}

}  // namespace pt
