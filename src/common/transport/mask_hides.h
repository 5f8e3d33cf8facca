// Masks as persistent warps evaluate them.
#pragma once

#include "common/transport/mask.h"

namespace pt {

/// Not part of the tracer's loop, which has no register to spare: masks are rare. `slot`: of a
/// triangle in a scene without instances. All by value: a pointer to a kernel's parameters would be
/// a generic address, which compute-sanitizer takes for an invalid one.
PT_NOINLINE inline bool mask_hides(MaskView masks, const Triangle* triangles, std::uint32_t ray_key,
                                   std::uint32_t slot, float b1, float b2) {
  return passes_mask(masks, ray_key, load_wide(&triangles[slot]), b1, b2, [] { return 0u; });
}

}  // namespace pt
