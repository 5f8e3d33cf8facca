// Steps 3a and 3b as one: the paper's 'reduced branching'. A miss is a surface that emits the sky
// and reflects nothing, so that all threads of a warp take the same way through the code.
#pragma once

#include "common/transport/path_integrator.h"

namespace pt {

/// The integrator's surface(), for a hit or a miss. The scene must have a primitive, whose data a
/// miss loads and then discards.
template <class Traits>
PT_HD_IN_KERNEL Scattering shade_any(const Scene& scene, const Ray& ray, const Hit& hit,
                                     PathState& path, const PathLimits& limits,
                                     const DrawnSteps& steps) {
  using Integrator = typename Traits::Integrator;
  const bool miss = hit.is_miss();
  const std::uint16_t shadow_rays = path.shadow_rays;
  const Color sky = Integrator::template miss<Traits::lighting>(scene, ray.direction, path, limits);
  Scattering result = Integrator::template surface<Traits>(scene, ray, miss ? Hit{1.0f, 0} : hit,
                                                           path, limits, steps);
  result.alive = result.alive && !miss;
  result.emitted = miss ? sky : result.emitted;
  result.shadow.radiance = miss ? Color(0.0f) : result.shadow.radiance;
  path.shadow_rays = miss ? shadow_rays : path.shadow_rays;
  return result;
}

}  // namespace pt
