#include "common/accel/trace_cpu/traverse_cwbvh_block.h"

#include "common/accel/trace_cpu/traverse_cwbvh_avx2.h"
#include "common/accel/trace_cpu/traverse_cwbvh_turns.h"
#include "common/accel/traverse_triangles.h"

namespace pt {

#ifdef __x86_64__

namespace {

struct TurnsByAvx2 {
  using Lanes = Lanes8;

  PT_AVX2 static std::uint32_t meet_node(const CwbvhNode& node, const TurnRay& ray,
                                         std::uint32_t octant) {
    return intersect_cwbvh_node_avx2(node, ray.origin, ray.inverse, octant, 0.0f, ray.t_max);
  }

  PT_AVX2 static void list_triangles(const CwbvhNode& node, std::uint32_t hits, std::uint32_t ray,
                                     TrianglePairs& pairs) {
    CwbvhGroup leaves = leaf_group(node, hits);
    while (leaves.has_slots()) {
      const CwbvhLeaf leaf = take_leaf(leaves);
      pairs.append(ray, leaf.first);
      if (leaf.count > 1) pairs.append(ray, leaf.first + 1);
    }
  }
};

}  // namespace

const TreeBlock* tree_block_avx2() {
  return has_avx2() ? &TreeBlockBy<TurnsByAvx2>::functions : nullptr;
}

#else

const TreeBlock* tree_block_avx2() { return nullptr; }

#endif

const TreeBlock* tree_block() {
  static const TreeBlock* const best =
      tree_block_avx512() != nullptr ? tree_block_avx512() : tree_block_avx2();
  return best;
}

}  // namespace pt
