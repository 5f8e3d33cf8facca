// Blocks of rays that the CPU traces together, by AVX-512 or AVX2 where the processor has it. Each
// ray finds the hit that it finds alone, bit for bit.
#pragma once

#include "common/accel/triangle_query.h"
#include "common/accel/triangle_tree.h"
#include "common/geometry/primitives.h"
#include "common/geometry/ray.h"

namespace pt {

struct RayBlock {
  static constexpr std::uint32_t size_max = 32;
  static constexpr std::uint32_t lanes_max = 16;  ///< of what tests several rays at once

  std::uint32_t count = 0;
  alignas(64) float origin[3][size_max];
  float direction[3][size_max];
  float t_max[size_max];  ///< hits count for 0 < t < t_max: 0 or less for a ray that meets nothing
  std::uint32_t
      key[size_max];  ///< for masks (transport/mask.h); read only in scenes that have them

  void append(const Ray& ray, float ray_t_max, std::uint32_t ray_key = 0) {
    key[count] = ray_key;
    for (int i = 0; i < 3; ++i) {
      origin[i][count] = ray.origin[i];
      direction[i][count] = ray.direction[i];
    }
    t_max[count++] = ray_t_max;
  }

  /// Fills the last lanes up with rays that meet nothing.
  void fill_lanes() {
    const std::uint32_t rays = count;
    while (count % lanes_max != 0) append({Vec3(0.0f), Vec3(0.0f, 0.0f, 1.0f)}, -1.0f);
    count = rays;
  }

  Ray ray(std::uint32_t i) const {
    return {{origin[0][i], origin[1][i], origin[2][i]},
            {direction[0][i], direction[1][i], direction[2][i]}};
  }
};

/// The nearest hits of a block's rays; for one that meets nothing `primitive` is no_primitive and
/// `t` is anything.
struct HitBlock {
  alignas(64) float t[RayBlock::size_max];
  std::uint32_t primitive[RayBlock::size_max];
};

// Every primitive against a block of rays (traverse_brute_lanes.h).

/// How the rays of a block are tested: lanes of a processor that may not be there. Rays are filled
/// up to whole lanes (RayBlock::fill_lanes). Functions that look for any hit return a bit for each
/// ray.
struct BruteBlock {
  void (*closest_primitives)(const Primitives&, const RayBlock&, HitBlock&);
  std::uint32_t (*any_primitive)(const Primitives&, const RayBlock&);
  // For a tree without instances; `primitive` is the slot.
  void (*closest_triangles)(const TriangleTree&, const RayBlock&, HitBlock&);
  std::uint32_t (*any_triangle)(const TriangleTree&, const RayBlock&);
};

/// Each null where the processor lacks it.
const BruteBlock* brute_block_avx2();
const BruteBlock* brute_block_avx512();

/// The best there is; null: one ray after the other.
const BruteBlock* brute_block();

// The rays of a block through the wide tree together (traverse_cwbvh_turns.h).

/// Decides about masked triangles, of which only a part is there.
struct BlockMask {
  const void* scene;
  /// Whether ray i of the block, which meets the triangle of this slot, goes through it.
  bool (*hides)(const void* scene, const RayBlock& rays, std::uint32_t i, std::uint32_t slot);
};

/// How the rays of a block are traced, in trees without instances. `mask` is null where no
/// triangle is masked.
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
