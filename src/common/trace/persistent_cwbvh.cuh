// Persistent threads on a compressed wide tree: warps that never wait for their slowest ray.
#pragma once

#include "common/trace/cwbvh_step.cuh"
#include "common/trace/ray_record.h"

namespace pt {

/// For an octant and a set of slots: the slot to visit first. In shared memory.
struct SlotOrder {
  std::uint8_t first[8][256];

  /// By all threads of the block; they must meet before the table is read.
  __device__ void fill() {
    for (std::uint32_t i = threadIdx.x; i < 8 * 256; i += blockDim.x) {
      const std::uint32_t octant = i >> 8, slots = i & 255u;
      std::uint32_t best = 0;
      for (std::uint32_t k = 8; k-- > 0;)
        if (slots >> (k ^ octant) & 1u) best = k ^ octant;
      first[octant][slots] = static_cast<std::uint8_t>(best);
    }
  }
};

/// Rays that a warp has prepared for its lanes, in shared memory.
struct alignas(16) RayPool {
  float4 part[5][32];
};

/// What is left of a node: bits 0..7 slots of inner children to visit, bits 8..15 its inner_mask.
struct SlotGroup {
  std::uint32_t base;
  std::uint32_t bits;
};

template <class Query, int block_size, int stack_shared, int refill, int nodes_least,
          int triangles_least, class Work>
__device__ void trace_persistent(const TriangleTree& tree, Work& work) {
  constexpr unsigned whole_warp = 0xffffffffu;
  __shared__ SlotOrder order;
  __shared__ RayPool pools[block_size / 32];
  __shared__ uint2 shared_stack[stack_shared > 0 ? stack_shared * block_size : 1];
  order.fill();
  __syncthreads();
  RayPool& pool = pools[threadIdx.x / 32];
  const unsigned lane = threadIdx.x & 31;
  uint2 local_stack[bvh_depth_max];
  int depth = 0;
  const auto push = [&](const SlotGroup& g) {
    if (depth < stack_shared) {
      shared_stack[depth * block_size + threadIdx.x] = {g.base, g.bits};
    } else {
      local_stack[depth - stack_shared] = {g.base, g.bits};
    }
    ++depth;
  };
  const auto pop = [&]() -> SlotGroup {
    --depth;
    const uint2 g = depth < stack_shared ? shared_stack[depth * block_size + threadIdx.x]
                                         : local_stack[depth - stack_shared];
    return {g.x, g.y};
  };

  int pool_next = 0, pool_size = 0;  // the same in all lanes
  bool dry = false;
  bool active = false, has_result = false;
  std::uint32_t index = 0;
  Query query(0, 0);
  Vec3 origin{}, inverse{};
  TriangleRay triangle_ray{};
  const std::uint8_t* slot_order = order.first[0];
  SlotGroup nodes{0, 0};
  std::uint32_t triangle_base = 0, triangle_bits = 0, leaf_slots = 0;
  uint2 meta{0, 0};

  while (true) {
    const unsigned idle = __ballot_sync(whole_warp, !active);
    if (__popc(idle) >= (dry ? 32 : refill)) {
      if (has_result) {
        work.finish(index, query);
        has_result = false;
      }
      if (pool_next >= pool_size) {
        __syncwarp();
        RayRecord record;
        const std::uint32_t first = work.fetch(lane, record, pool_size);
        pool_next = 0;
        if (static_cast<int>(lane) < pool_size) {
          const Ray ray = record.ray();
          const CwbvhRay r = make_cwbvh_ray(ray);
          const TriangleRay& t = r.triangles;
          const float t_max = is_traceable(ray) ? record.t_max : -1.0f;
          pool.part[0][lane] = {r.origin.x, r.origin.y, r.origin.z, record.t_min};
          pool.part[1][lane] = {r.inverse.x, r.inverse.y, r.inverse.z, t_max};
          pool.part[2][lane] = {t.x_axis.x, t.x_axis.y, t.x_axis.z, __uint_as_float(first + lane)};
          pool.part[3][lane] = {t.y_axis.x, t.y_axis.y, t.y_axis.z, __uint_as_float(7 - r.octant)};
          pool.part[4][lane] = {t.along.x, t.along.y, t.along.z, 0.0f};
        }
        __syncwarp();
        if (pool_size == 0) {
          dry = true;
          if (idle == whole_warp) return;
        }
      }
      const int place = pool_next + __popc(idle & ((1u << lane) - 1));
      if (!active && place < pool_size) {
        const float4 a = pool.part[0][place], b = pool.part[1][place], c = pool.part[2][place],
                     d = pool.part[3][place], e = pool.part[4][place];
        origin = {a.x, a.y, a.z};
        inverse = {b.x, b.y, b.z};
        triangle_ray = {origin, {c.x, c.y, c.z}, {d.x, d.y, d.z}, {e.x, e.y, e.z}};
        query = Query(a.w, b.w);
        index = __float_as_uint(c.w);
        slot_order = order.first[__float_as_uint(d.w)];
        nodes = {tree.root, 1u};
        has_result = true;
        active = b.w > 0.0f;
      }
      pool_next += __popc(idle);
    }
    // Down the tree.
    for (bool first = true;; first = false) {
      const bool steps = (nodes.bits & 0xffu) != 0 && leaf_slots == 0 && triangle_bits == 0 && active;
      const unsigned stepping = __ballot_sync(whole_warp, steps);
      if (stepping == 0 || (!first && __popc(stepping) < nodes_least)) break;
      if (steps) {
        const std::uint32_t slot = slot_order[nodes.bits & 0xffu];
        const std::uint32_t bit = 1u << slot;
        const std::uint32_t child =
            nodes.base + __popc((nodes.bits >> 8) & (bit - 1));
        nodes.bits ^= bit;
        if ((nodes.bits & 0xffu) != 0) push(nodes);
        const CwbvhWords node = load_cwbvh_words(&tree.cwbvh[child]);
        const std::uint32_t hits = hit_slots(node, origin, inverse, query.t_max());
        const std::uint32_t inner = node.inner_mask();
        nodes = {node.child_base(), (hits & inner) | inner << 8};
        leaf_slots = hits & ~inner;
        triangle_base = node.triangle_base();
        meta = node.meta();
        if ((nodes.bits & 0xffu) == 0 && depth > 0) nodes = pop();
      }
    }
    // Triangles.
    while (leaf_slots != 0) {
      const std::uint32_t slot = __ffs(static_cast<int>(leaf_slots)) - 1;
      leaf_slots &= leaf_slots - 1;
      const std::uint32_t m = __byte_perm(meta.x, meta.y, slot) & 0xffu;
      triangle_bits |= (m >> 5) << (m & 31u);
    }
    while (true) {
      const unsigned testing = __ballot_sync(whole_warp, triangle_bits != 0);
      if (testing == 0) break;
      if (triangle_bits != 0) {
        const int bit = __ffs(static_cast<int>(triangle_bits)) - 1;
        triangle_bits &= triangle_bits - 1;
        const std::uint32_t triangle = triangle_base + static_cast<std::uint32_t>(bit);
        const Triangle t = load_wide(&tree.triangles[triangle]);
        const TriangleHit hit = intersect_triangle(triangle_ray, t.v0, t.v1, t.v2);
        if (query.offer(tree, hit.t, triangle, 0)) {
          nodes.bits = 0;
          triangle_bits = 0;
          depth = 0;
        }
      }
      if (__popc(testing) < triangles_least) break;
    }
    if ((nodes.bits & 0xffu) == 0 && triangle_bits == 0) active = false;
  }
}

}  // namespace pt
