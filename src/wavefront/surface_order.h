// Orders the queue of surfaces by BSDF type: a counting sort of each tile of the queue.
// Neighbouring threads then execute the same code (after Laine et al. 2013, 'Megakernels Considered
// Harmful', section 4), and neighbours in the queue stay close in memory.
//
// Contract: each tile of the ordered queue holds the same slots as that tile of the queue,
// ascending by BSDF type; the order within one type is unspecified on CUDA and that of the queue on
// the CPU.
#pragma once

#include "common/transport/surface.h"
#include "wavefront/pool/path_pool.h"
#include "wavefront/pool/wave_counters.h"

namespace pt {

/// Entries of a tile: enough for warps of one BSDF type, few enough for a block's shared memory.
inline constexpr std::uint32_t order_tile = 1 << 14;

struct SurfaceOrder {
  PathPool pool;
  const std::uint32_t* slots = nullptr;  ///< the queue, the first *count of it
  const std::uint32_t* count = nullptr;
  std::uint32_t* ordered = nullptr;  ///< [capacity of the queue]
};

/// The BSDF type of the surface that the slot's ray hit; 0 for a miss, which is in this queue with
/// branch-free shading.
PT_HD std::uint8_t surface_kind(const Scene& scene, const PathPool& pool, std::uint32_t slot) {
  const Hit hit = pool.load_hit(slot);
  if (hit.is_miss()) return 0;
  const std::uint32_t material = material_index_at(scene, hit);
  return static_cast<std::uint8_t>(scene.material(material).kind);
}

/// On the calling thread's oneTBB arena.
void order_surfaces_cpu(const Scene& scene, const SurfaceOrder& order);

}  // namespace pt
