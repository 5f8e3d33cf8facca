// Masks as persistent warps evaluate them.
#pragma once

#include "common/transport/mask.h"

namespace pt {

/// Apart from the tracer's loop, which has no register to spare: masks are rare. `slot`: of a
/// triangle in a scene without instances.
PT_NOINLINE inline bool mask_hides(const Scene* scene, std::uint32_t ray_key, std::uint32_t slot,
                                   float b1, float b2) {
  const Triangle triangle = load_wide(&scene->triangles.triangles[slot]);
  return MaskTest{*scene, ray_key}.hides(triangle, {0.0f, b1, b2}, 0);
}

}  // namespace pt
