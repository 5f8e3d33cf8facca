// The contract of an integrator: what a path is worth where it leaves the scene, and what a surface
// does with it. The modes call nothing else of an integrator, so it is independent of the mode:
//   Color miss<lighting>(scene, direction, path, limits)   added to the sample; the path ends
//   Scattering surface<Traits>(scene, ray, hit, path, limits, steps)
//                                                          see shade_surface.h
//   Scattering medium<Traits>(scene, ray, distance, path, limits, steps)
//                                                          likewise of a collision in a medium
// `path` may change in surface(), but not in miss(). `steps` (surface_steps.h) has the blocks of
// random numbers of the ray that hit, and may take results before surface() returns.
//
// Adding one: a file here, its name among the IntegratorKinds, and its type with the kinds of
// scenes for which it has kernels in render/dispatch.h. tests/transport/test_integrators.cpp has a
// second one.
#pragma once

#include "common/transport/shade_miss.h"
#include "common/transport/shade_surface.h"
#include "common/transport/travel.h"

namespace pt {

/// Unidirectional path tracing with multiple importance sampling (pbrt-v4, section 13.2.2).
struct PathIntegrator {
  template <Lighting lighting>
  PT_HD static Color miss(const Scene& scene, const Vec3& direction, const PathState& path,
                          const PathLimits& limits) {
    return shade_miss<lighting>(scene, direction, path, limits.mis);
  }

  template <class Traits, class Steps>
  PT_HD_IN_KERNEL static Scattering surface(const Scene& scene, const Ray& ray, const Hit& hit,
                                            PathState& path, const PathLimits& limits,
                                            const Steps& steps) {
    return shade_surface<Traits>(scene, ray, hit, path, limits, steps);
  }

  template <class Traits, class Steps>
  PT_HD_IN_KERNEL static Scattering medium(const Scene& scene, const Ray& ray, float distance,
                                           PathState& path, const PathLimits& limits,
                                           const Steps& steps) {
    return scatter_in_medium<Traits>(scene, ray, distance, path, limits, steps);
  }
};

}  // namespace pt
