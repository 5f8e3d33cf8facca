// Coherent rays as a beam: a warp's 32 rays go down the tree as one, its lanes test boxes instead
// of rays.
//
// Neighbouring camera rays visit nearly the same nodes: on a mesh of 70 k triangles the 32 rays of
// an 8 x 4 tile visit 28 nodes of a binary tree together and 27 each. So the warp bounds its rays
// by intervals of origins and of inverse directions, and traverses the wide tree with interval
// arithmetic (Boulos, Wald and Shirley 2006, 'Geometric and Arithmetic Culling Methods for Entire
// Ray Packets'), one child per lane, four nodes at a time. Leaves that the beam meets are queued in
// shared memory; then each lane tests their boxes against its own ray, and the triangles of those
// that it hits. Nodes lie near to far on the stack, by the octant all rays have in common.
#pragma once

#include "common/trace/cwbvh_step.cuh"

namespace pt {

inline constexpr unsigned whole_warp = 0xffffffffu;

/// A leaf that the beam met: where a ray enters and leaves its slabs, and its triangles.
struct alignas(16) BeamLeaf {
  Vec3 near;
  std::uint32_t first;
  Vec3 far;
  std::uint32_t count;
};

/// What a warp needs in shared memory.
template <int stack_size, int leaf_capacity>
struct BeamMemory {
  BeamLeaf leaves[leaf_capacity];
  std::uint32_t stack[stack_size];
};

__device__ inline int order_of_float(float x) {
  const int bits = __float_as_int(x);
  return bits ^ ((bits >> 31) & 0x7fffffff);
}
__device__ inline float float_of_order(int order) {
  return __int_as_float(order ^ ((order >> 31) & 0x7fffffff));
}
__device__ inline float warp_min(float x) {
  return float_of_order(__reduce_min_sync(whole_warp, order_of_float(x)));
}
__device__ inline float warp_max(float x) {
  return float_of_order(__reduce_max_sync(whole_warp, order_of_float(x)));
}

/// The intervals of a warp's rays; the same in all lanes. `near_origin` is the end of the origins'
/// interval from which near planes are nearest.
struct Beam {
  Vec3 near_origin, far_origin;
  Vec3 low_inverse, high_inverse;
  std::uint32_t negative;  ///< bit `axis`: directions are negative
  bool is_coherent;        ///< all directions have the same signs
  float origin_slack;      ///< rounding errors of the order of the origins' size
};

/// A beam wider than this (of a dominant component of the direction) does not pay.
inline constexpr float beam_width_max = 0.25f;

__device__ inline Beam make_beam(const Vec3& origin, const Vec3& inverse) {
  Beam beam;
  beam.negative = 0;
  beam.is_coherent = true;
  float size = 0.0f, narrowest = HUGE_VALF;
  PT_UNROLL(3)
  for (int i = 0; i < 3; ++i) {
    const unsigned negative = __ballot_sync(whole_warp, inverse[i] < 0.0f);
    beam.is_coherent &= negative == 0 || negative == whole_warp;
    if (negative != 0) beam.negative |= 1u << i;
    const float low = warp_min(origin[i]), high = warp_max(origin[i]);
    beam.low_inverse[i] = warp_min(inverse[i]);
    beam.high_inverse[i] = warp_max(inverse[i]);
    beam.near_origin[i] = negative != 0 ? low : high;
    beam.far_origin[i] = negative != 0 ? high : low;
    size = fmaxf(size, fmaxf(fabsf(low), fabsf(high)));
    const float a = fabsf(beam.low_inverse[i]), b = fabsf(beam.high_inverse[i]);
    narrowest = fminf(narrowest, fabsf(a - b) / fminf(a, b));
  }
  beam.origin_slack = slab_tolerance * size;
  beam.is_coherent &= narrowest < beam_width_max;
  return beam;
}

/// A child's planes, sorted by where the beam enters and leaves; widened by more than rounding.
struct BeamBox {
  Vec3 near, far;
};

__device__ inline float load_beam_plane(const std::uint8_t* q, float slack, float scale,
                                        float origin) {
  return __fmaf_rn(static_cast<float>(__ldg(q)) + slack, scale, origin);
}

/// `slot` differs from lane to lane, `beam` does not.
__device__ inline BeamBox load_beam_box(const CwbvhNode* node, const float4& head,
                                        std::uint32_t slot, const Beam& beam) {
  constexpr float grid_slack = 1.0f / 1024.0f;
  const auto* planes = reinterpret_cast<const std::uint8_t*>(node) + 32 + slot;
  const std::uint32_t exponents = __float_as_uint(head.w);
  const float grid_origin[3] = {head.x, head.y, head.z};
  BeamBox box;
  PT_UNROLL(3)
  for (int i = 0; i < 3; ++i) {
    const bool negative = (beam.negative >> i & 1u) != 0;
    const float sign = negative ? -1.0f : 1.0f;
    const float scale = bits_to_float((exponents >> (8 * i) & 0xffu) << 23);
    const int near = 8 * i + (negative ? 24 : 0), far = 8 * i + (negative ? 0 : 24);
    const float slack = sign * beam.origin_slack;
    box.near[i] =
        load_beam_plane(planes + near, -sign * grid_slack, scale, grid_origin[i] - slack);
    box.far[i] = load_beam_plane(planes + far, sign * grid_slack, scale, grid_origin[i] + slack);
  }
  return box;
}

__device__ inline bool beam_meets(const Beam& beam, const BeamBox& box, float t_max) {
  float near = 0.0f, far = t_max;
  PT_UNROLL(3)
  for (int i = 0; i < 3; ++i) {
    const float to_near = box.near[i] - beam.near_origin[i];
    const float to_far = box.far[i] - beam.far_origin[i];
    near = fmaxf(near, fminf(to_near * beam.low_inverse[i], to_near * beam.high_inverse[i]));
    far = fminf(far, fmaxf(to_far * beam.low_inverse[i], to_far * beam.high_inverse[i]));
  }
  return near <= far * (1.0f + 2.0f * slab_tolerance);
}

/// A single ray against a leaf's box, by products: offset = -origin * inverse.
__device__ inline bool ray_meets(const BeamLeaf& leaf, const Vec3& inverse, const Vec3& offset,
                                 float t_max) {
  const auto at = [&](const Vec3& plane, int i) {
    return __float_as_int(__fmaf_rn(plane[i], inverse[i], offset[i]));
  };
  const int near = __vimax3_s32(at(leaf.near, 0), at(leaf.near, 1), max(at(leaf.near, 2), 0));
  const int far = __vimin3_s32(at(leaf.far, 0), at(leaf.far, 1),
                               min(at(leaf.far, 2), __float_as_int(t_max)));
  return __int_as_float(near) <= __int_as_float(far) * (1.0f + 2.0f * slab_tolerance);
}

/// Traces the warp's rays as a beam. False: they are not coherent, or the stack has overflowed;
/// then the query may hold hits already, but not all.
template <class Query, int stack_size, int leaf_capacity, int leaf_batch>
__device__ bool trace_beam(const TriangleTree& tree, const Ray& ray,
                           BeamMemory<stack_size, leaf_capacity>& memory, Query& query) {
  static_assert(leaf_batch + 32 <= leaf_capacity);
  const unsigned lane = threadIdx.x & 31;
  const unsigned lanes_below = (1u << lane) - 1;
  const CwbvhRay prepared = make_cwbvh_ray(ray);
  const Beam beam = make_beam(ray.origin, prepared.inverse);
  if (!beam.is_coherent || !__all_sync(whole_warp, is_traceable(ray))) return false;
  const Vec3 inverse = prepared.inverse;
  const Vec3 offset = -ray.origin * inverse;
  const std::uint32_t slot = (lane & 7u) ^ beam.negative;
  float beam_t_max = warp_max(query.t_max());
  bool is_done = false;
  int size = 1, leaf_count = 0;
  if (lane == 0) memory.stack[0] = tree.root;
  while (true) {
    __syncwarp();
    const int popped = min(size, 4);
    const int group = static_cast<int>(lane >> 3);
    bool is_hit = false, is_inner = false;
    std::uint32_t child = 0, triangles = 0;
    BeamBox box{};
    if (group < popped) {
      const CwbvhNode* node = &tree.cwbvh[memory.stack[size - 1 - group]];
      const float4 head = __ldg(reinterpret_cast<const float4*>(node));
      const uint2 bases = __ldg(reinterpret_cast<const uint2*>(node) + 2);
      const std::uint32_t meta = __ldg(node->meta + slot);
      box = load_beam_box(node, head, slot, beam);
      is_hit = meta != 0 && beam_meets(beam, box, beam_t_max);
      const std::uint32_t inner_mask = __float_as_uint(head.w) >> 24;
      is_inner = (inner_mask >> slot & 1u) != 0;
      child = is_inner ? bases.x + __popc(inner_mask & ((1u << slot) - 1)) : bases.y + (meta & 31u);
      triangles = __popc(meta >> 5);
    }
    const unsigned inner = __ballot_sync(whole_warp, is_hit && is_inner);
    const unsigned leaves = __ballot_sync(whole_warp, is_hit && !is_inner);
    size += __popc(inner) - popped;
    if (is_hit && is_inner) memory.stack[size - 1 - __popc(inner & lanes_below)] = child;
    if (is_hit && !is_inner) {
      memory.leaves[leaf_count + __popc(leaves & lanes_below)] = {box.near, child, box.far,
                                                                 triangles};
    }
    leaf_count += __popc(leaves);
    if (size > stack_size - 32) return false;
    if (leaf_count < leaf_batch && size > 0) continue;
    __syncwarp();
    for (int begin = 0; begin < leaf_count; begin += 32) {
      const int end = min(leaf_count, begin + 32);
      std::uint32_t mask = 0;
      for (int i = begin; i < end; ++i) {
        const BeamLeaf leaf = load_wide(&memory.leaves[i]);
        if (ray_meets(leaf, inverse, offset, query.t_max())) mask |= 1u << (i - begin);
      }
      if (is_done) mask = 0;
      std::uint32_t triangle = 0, stop = 0;
      while (true) {
        if (triangle == stop && mask != 0) {
          const int i = begin + __ffs(static_cast<int>(mask)) - 1;
          mask &= mask - 1;
          triangle = memory.leaves[i].first;
          stop = triangle + memory.leaves[i].count;
        }
        if (!__any_sync(whole_warp, triangle != stop)) break;
        if (triangle != stop) {
          const Triangle t = load_wide(&tree.triangles[triangle]);
          const TriangleHit hit = intersect_triangle(prepared.triangles, t.v0, t.v1, t.v2);
          is_done = query.offer(tree, hit.t, triangle, 0);
          ++triangle;
          if (is_done) triangle = stop, mask = 0;
        }
      }
    }
    leaf_count = 0;
    beam_t_max = warp_max(is_done ? 0.0f : query.t_max());
    if (size == 0 || __all_sync(whole_warp, is_done)) return true;
  }
}

}  // namespace pt
