// Step 2 of many paths at once, for the CPU: the hits of a block of rays. The same, bit for
// bit, as intersect.h finds for one ray after the other.
#pragma once

#include "common/accel/trace_cpu/ray_block.h"
#include "common/scene/data/scene.h"

namespace pt {

/// Which kind of rays there is: a scene's without lights.
struct BlockTraits {
  Accel accel;
  Geometry geometry;
  bool has_masks = false;
  bool has_media = false;  ///< no matter to rays
};

/// Whether rays of such scenes are traced in blocks: where that is another way to trace them.
constexpr bool traces_blocks(const BlockTraits& traits) {
  if (traits.has_masks) return traits.accel == Accel::cwbvh;
  return traits.accel == Accel::brute || traits.accel == Accel::cwbvh_avx2;
}

/// Rays that have a key for masks (path_hash).
using MaskedRays = Traits<Accel::cwbvh, Geometry::mixed, Lighting::sky, true>;

/// The closest hits of rays whose t_max is infinite_distance; hits[i] is ray i's. `rays` is filled
/// up to whole lanes.
void intersect_closest_block(const BlockTraits& traits, const Scene& scene, RayBlock& rays,
                             Hit* hits);

/// Bit i of the result: something lies on ray i nearer than its t_max.
std::uint32_t intersect_shadow_block(const BlockTraits& traits, const Scene& scene, RayBlock& rays);

}  // namespace pt
