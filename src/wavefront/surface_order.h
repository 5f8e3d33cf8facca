// The surfaces that wait to be shaded, ordered by the kind of their BSDFs: a counting sort of their
// queue. Threads side by side then execute the same code (after Laine et al. 2013, 'Megakernels
// Considered Harmful', section 4). One kernel for all kinds needs no more than an order within
// tiles of the queue, and what was near in the queue stays near in memory. A kernel for one
// kind needs all of its surfaces in one range.
//
// Contract: the ordered queue holds the same slots as the queue, either range by range (KindRanges)
// or tile by tile and ascending by kind in each; within one kind in any order, on the CPU in that
// of the queue.
#pragma once

#include "common/transport/surface.h"
#include "wavefront/pool/path_pool.h"
#include "wavefront/pool/wave_counters.h"

namespace pt {

/// Places of the queue that are ordered together: enough for warps of one kind, few enough that a
/// block's threads keep their kinds.
inline constexpr std::uint32_t order_tile = 1 << 14;

struct SurfaceOrder {
  PathPool pool;
  const std::uint32_t* slots = nullptr;  ///< the queue, the first *count of it
  const std::uint32_t* count = nullptr;
  std::uint32_t* ordered = nullptr;  ///< [capacity of the queue]
  // For ranges; null: within tiles
  KindRanges* ranges = nullptr;   ///< counts and indices are 0 before
  std::uint8_t* kinds = nullptr;  ///< [capacity of the queue] room for the kind of each entry
};

/// That of the surface that the slot's path has met; 0 for a miss, which waits among the surfaces
/// where branches are reduced.
PT_HD std::uint8_t surface_kind(const Scene& scene, const PathPool& pool, std::uint32_t slot) {
  const Hit hit = pool.load_hit(slot);
  if (hit.is_miss()) return 0;
  const std::uint32_t material = material_index_at(scene, hit);
  return static_cast<std::uint8_t>(scene.material(material).kind);
}

/// On the calling thread's oneTBB arena.
void order_surfaces_cpu(const Scene& scene, const SurfaceOrder& order);

}  // namespace pt
