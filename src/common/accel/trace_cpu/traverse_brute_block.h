// Every primitive against a block of rays: what traverse_brute.h and traverse_triangles_brute.h
// find one ray after the other, bit for bit. By AVX-512 or AVX2 where the processor has it.
#pragma once

#include "common/accel/trace_cpu/ray_block.h"
#include "common/accel/triangle_tree.h"
#include "common/geometry/primitives.h"

namespace pt {

/// How the rays of a block are tested: lanes of a processor that may not be there. Rays are filled
/// up to whole lanes (RayBlock::fill_lanes). What meets anything is a bit for each ray.
struct BruteBlock {
  void (*closest_primitives)(const Primitives&, const RayBlock&, HitBlock&);
  std::uint32_t (*any_primitive)(const Primitives&, const RayBlock&);
  // Of a tree without instances; `primitive` is the slot.
  void (*closest_triangles)(const TriangleTree&, const RayBlock&, HitBlock&);
  std::uint32_t (*any_triangle)(const TriangleTree&, const RayBlock&);
};

/// Each null where the processor lacks it.
const BruteBlock* brute_block_avx2();
const BruteBlock* brute_block_avx512();

/// The best there is; null: one ray after the other.
const BruteBlock* brute_block();

}  // namespace pt
