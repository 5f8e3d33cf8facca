// The rays of a block through the wide tree together, on processors with AVX2 or AVX-512
// (traverse_cwbvh_turns.h). Each finds what it finds alone, bit for bit.
#pragma once

#include "common/accel/trace_cpu/ray_block.h"
#include "common/accel/triangle_query.h"

namespace pt {

/// Asked about triangles of which only a part is there.
struct BlockMask {
  const void* scene;
  /// Whether ray i of the block, which meets the triangle of this slot, goes through it.
  bool (*hides)(const void* scene, const RayBlock& rays, std::uint32_t i, std::uint32_t slot);
};

/// How the rays of a block are traced, in trees without instances. `mask` is null where all of
/// every triangle is there.
struct TreeBlock {
  void (*closest)(const TriangleTree& tree, const RayBlock& rays, const BlockMask* mask,
                  HitBlock& hits);
  /// A bit for each ray that meets anything.
  std::uint32_t (*any)(const TriangleTree& tree, const RayBlock& rays, const BlockMask* mask);
};

/// Each null where the processor lacks it.
const TreeBlock* tree_block_avx2();
const TreeBlock* tree_block_avx512();

/// The best there is; null: one ray after the other.
const TreeBlock* tree_block();

}  // namespace pt
