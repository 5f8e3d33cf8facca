// Rays, alone and in blocks, by AVX2.
#include "common/accel/trace_cpu/ray_block.h"
#include "common/accel/trace_cpu/traverse_brute_lanes.h"
#include "common/accel/trace_cpu/traverse_cwbvh_avx2.h"
#include "common/accel/trace_cpu/traverse_cwbvh_turns.h"
#include "common/accel/traverse_triangles.h"

namespace pt {

#ifdef __x86_64__

bool has_avx2() {
  static const bool has = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") &&
                          __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("popcnt");
  return has;
}

template <class Query>
void traverse_triangles_avx2(const TriangleTree& tree, const Ray& ray, Query& query) {
  tree.instance_count > 0 ? traverse_cwbvh_avx2<true>(tree, ray, query)
                          : traverse_cwbvh_avx2<false>(tree, ray, query);
}

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

const BruteBlock* brute_block_avx2() { return has_avx2() ? &brute_block_by<Lanes8> : nullptr; }

#else

bool has_avx2() { return false; }

template <class Query>
void traverse_triangles_avx2(const TriangleTree& tree, const Ray& ray, Query& query) {
  traverse_cwbvh<true>(tree, ray, query);
}

const TreeBlock* tree_block_avx2() { return nullptr; }

const BruteBlock* brute_block_avx2() { return nullptr; }

#endif

template void traverse_triangles_avx2(const TriangleTree&, const Ray&, ClosestTriangle&);
template void traverse_triangles_avx2(const TriangleTree&, const Ray&, AnyTriangle&);
template void traverse_triangles_avx2(const TriangleTree&, const Ray&,
                                      MovingQuery<ClosestTriangle>&);
template void traverse_triangles_avx2(const TriangleTree&, const Ray&, MovingQuery<AnyTriangle>&);

const TreeBlock* tree_block() {
  static const TreeBlock* const best =
      tree_block_avx512() != nullptr ? tree_block_avx512() : tree_block_avx2();
  return best;
}

const BruteBlock* brute_block() {
  static const BruteBlock* const best =
      brute_block_avx512() != nullptr ? brute_block_avx512() : brute_block_avx2();
  return best;
}

}  // namespace pt
