// Coherent rays as a beam: a warp's 32 rays go down the tree as one, its lanes test boxes instead
// of rays.
//
// Neighbouring camera rays visit nearly the same nodes: on a mesh of 70 k triangles the 32 rays of
// an 8 x 4 tile visit 28 nodes of a binary tree together and 27 each. So the warp bounds its rays
// by intervals of origins and of inverse directions, and traverses the wide tree with interval
// arithmetic (Boulos, Wald and Shirley 2006, 'Geometric and Arithmetic Culling Methods for Entire
// Ray Packets'), one child per lane, four nodes at a time. Leaves that the beam meets are queued in
// shared memory; then each lane tests their boxes against its own ray, and the triangles of those
// that it hits. Nodes lie near to far on the stack, by the octant that all rays have in common.
#pragma once

#include "common/trace/cwbvh_step.cuh"

namespace pt {

/// A leaf that the beam met: where a ray enters and leaves its slabs, relative to Beam::center, and
/// its triangles.
struct alignas(16) BeamLeaf {
  Vec3 near;
  std::uint32_t first;
  Vec3 far;
  std::uint32_t count;
};

/// What bounds a warp's rays, axis by axis, in shared memory. Distances are relative to `center`,
/// the first ray's origin. Along an axis the beam enters a plane at distance d not before
/// d * near_inverse + near_offset, and leaves it not after d * far_inverse + far_offset.
struct alignas(16) Beam {
  float center[4];
  float outward[4];  ///< slab_tolerance, or less that for positive directions
  float near_inverse[4], near_offset[4];
  float far_inverse[4], far_offset[4];
};

/// What a warp needs in shared memory.
template <int stack_size, int leaf_capacity>
struct BeamMemory {
  Beam beam;
  BeamLeaf leaves[leaf_capacity];
  std::uint32_t stack[stack_size];
};

__device__ inline float warp_min_magnitude(float x) {
  return __uint_as_float(__reduce_min_sync(0xffffffffu, __float_as_uint(x) & 0x7fffffffu));
}
__device__ inline float warp_max_magnitude(float x) {
  return __uint_as_float(__reduce_max_sync(0xffffffffu, __float_as_uint(x) & 0x7fffffffu));
}

/// Beams wider than this, relative to their direction, do not pay.
inline constexpr float beam_width_max = 0.25f;

/// Sets `width` to how much the directions differ; false: in their signs.
__device__ inline bool make_beam_axis(float origin, float inverse, int i, Beam& beam,
                                      float& width) {
  constexpr unsigned whole_warp = 0xffffffffu;
  const unsigned negative = __ballot_sync(whole_warp, inverse < 0.0f);
  const float center = __shfl_sync(whole_warp, origin, 0);
  const float spread = __all_sync(whole_warp, origin == center)
                           ? 0.0f
                           : warp_max_magnitude(origin - center) * (1.0f + slab_tolerance);
  const float least = warp_min_magnitude(inverse), most = warp_max_magnitude(inverse);
  beam.center[i] = center;
  beam.outward[i] = negative != 0 ? slab_tolerance : -slab_tolerance;
  beam.near_inverse[i] = negative != 0 ? -least : least;
  beam.far_inverse[i] = negative != 0 ? -most : most;
  beam.near_offset[i] = -spread * least;
  beam.far_offset[i] = spread * most;
  width = (most - least) / least;
  return negative == 0 || negative == whole_warp;
}

/// Planes of a lane's child along axis `i`, where the beam enters and leaves; relative to its
/// center, and widened by more than rounding errors.
__device__ inline float2 beam_planes(const Beam& beam, int i, std::uint32_t low,
                                     std::uint32_t high, float scale, float grid_origin) {
  constexpr float grid_slack = 2048.0f;  // in units of slab_tolerance: 2^-10 of a step
  const float outward = beam.outward[i];
  const bool negative = outward > 0.0f;
  const float base = grid_origin - beam.center[i];
  const float size = __fmaf_rn(scale, grid_slack, fabsf(base));
  const float near = static_cast<float>(negative ? high : low);
  const float far = static_cast<float>(negative ? low : high);
  return {__fmaf_rn(near, scale, __fmaf_rn(size, outward, base)),
          __fmaf_rn(far, scale, __fmaf_rn(size, -outward, base))};
}

/// A single ray against a leaf's box: offset = (center - origin) * inverse.
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
  constexpr unsigned whole_warp = 0xffffffffu;
  const unsigned lane = threadIdx.x & 31;
  const CwbvhRay prepared = make_cwbvh_ray(ray);
  const Vec3 inverse = prepared.inverse;
  Beam& beam = memory.beam;
  float width_x, width_y, width_z;
  bool is_coherent = is_traceable(ray);
  is_coherent &= make_beam_axis(ray.origin.x, inverse.x, 0, beam, width_x);
  is_coherent &= make_beam_axis(ray.origin.y, inverse.y, 1, beam, width_y);
  is_coherent &= make_beam_axis(ray.origin.z, inverse.z, 2, beam, width_z);
  is_coherent &= fminf(width_x, fminf(width_y, width_z)) < beam_width_max;
  if (!__all_sync(whole_warp, is_coherent)) return false;
  __syncwarp();
  const Vec3 offset = {(beam.center[0] - ray.origin.x) * inverse.x,
                       (beam.center[1] - ray.origin.y) * inverse.y,
                       (beam.center[2] - ray.origin.z) * inverse.z};
  const std::uint32_t slot = (lane & 7u) ^ (7u - prepared.octant);
  const int group = static_cast<int>(lane >> 3);
  const unsigned lanes_below = (1u << lane) - 1;
  float beam_t_max = warp_max_magnitude(query.t_max());
  bool is_done = false;
  int size = 1, leaf_count = 0;
  if (lane == 0) memory.stack[0] = tree.root;
  while (true) {
    __syncwarp();
    const int place = size - 1 - group;
    const auto* node =
        reinterpret_cast<const std::uint8_t*>(&tree.cwbvh[memory.stack[max(place, 0)]]);
    const uint4 head = __ldg(reinterpret_cast<const uint4*>(node));
    const uint2 bases = __ldg(reinterpret_cast<const uint2*>(node) + 2);
    const std::uint8_t* mine = node + slot;
    const std::uint32_t meta = __ldg(mine + 24);
    const float2 x =
        beam_planes(beam, 0, __ldg(mine + 32), __ldg(mine + 56),
                    __uint_as_float((head.w & 0xffu) << 23), __uint_as_float(head.x));
    const float2 y =
        beam_planes(beam, 1, __ldg(mine + 40), __ldg(mine + 64),
                    __uint_as_float((head.w & 0xff00u) << 15), __uint_as_float(head.y));
    const float2 z =
        beam_planes(beam, 2, __ldg(mine + 48), __ldg(mine + 72),
                    __uint_as_float((head.w & 0xff0000u) << 7), __uint_as_float(head.z));
    const auto nearer = [&](int i, float plane) {
      return __fmaf_rn(plane, beam.near_inverse[i], beam.near_offset[i]);
    };
    const auto farther = [&](int i, float plane) {
      return __fmaf_rn(plane, beam.far_inverse[i], beam.far_offset[i]);
    };
    const float near = fmaxf(fmaxf(nearer(0, x.x), nearer(1, y.x)), fmaxf(nearer(2, z.x), 0.0f));
    const float far =
        fminf(fminf(farther(0, x.y), farther(1, y.y)), fminf(farther(2, z.y), beam_t_max));
    const bool is_hit =
        place >= 0 && meta != 0 && near <= far * (1.0f + 2.0f * slab_tolerance);
    const std::uint32_t inner_mask = head.w >> 24;
    const bool is_inner = (inner_mask >> slot & 1u) != 0;
    const unsigned inner = __ballot_sync(whole_warp, is_hit && is_inner);
    const unsigned leaves = __ballot_sync(whole_warp, is_hit && !is_inner);
    size = max(size - 4, 0) + __popc(inner);
    __syncwarp();
    if (is_hit && is_inner) {
      memory.stack[size - 1 - __popc(inner & lanes_below)] =
          bases.x + __popc(inner_mask & ((1u << slot) - 1));
    }
    if (is_hit && !is_inner) {
      memory.leaves[leaf_count + __popc(leaves & lanes_below)] = {
          {x.x, y.x, z.x}, bases.y + (meta & 31u), {x.y, y.y, z.y},
          static_cast<std::uint32_t>(__popc(meta >> 5))};
    }
    leaf_count += __popc(leaves);
    if (size > stack_size - 32) return false;
    if (leaf_count < leaf_batch && size > 0) continue;
    __syncwarp();
    for (int begin = 0; begin < leaf_count; begin += 32) {
      const int end = min(leaf_count - begin, 32);
      const BeamLeaf* leaf = &memory.leaves[begin];
      std::uint32_t mask = 0;
      for (int i = 0; i < end; ++i) {
        if (ray_meets(load_wide(leaf + i), inverse, offset, query.t_max())) mask |= 1u << i;
      }
      if (is_done) mask = 0;
      std::uint32_t triangle = 0, stop = 0;
      while (true) {
        if (triangle == stop && mask != 0) {
          const int i = __ffs(static_cast<int>(mask)) - 1;
          mask &= mask - 1;
          triangle = leaf[i].first;
          stop = triangle + leaf[i].count;
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
    beam_t_max = warp_max_magnitude(is_done ? 0.0f : query.t_max());
    if (size == 0 || __all_sync(whole_warp, is_done)) return true;
  }
}

}  // namespace pt
