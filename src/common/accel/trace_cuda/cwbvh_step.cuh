// One step of the wide tree's traversal as the GPU does it fastest.
//
// The same test as intersect_cwbvh_node in fewer and cheaper instructions. On sm_90 a conversion of
// a byte to a float takes 8 cycles of a scheduler's time, and a node has 48 of them: most of its
// cost. A byte that is multiplied into the mantissa of a float with the right exponent needs no
// conversion: the float is bias + q, and the bias goes into the plane's offset. The instruction
// that does it, dp2a, has two products: of which of a child's two planes depends on the ray, so
// that nothing is left to select. Minima and maxima take three operands at once, as integers, whose
// order is that of floats that are not negative. The children that are hit become bits of one word
// by the signs of far - near.
#pragma once

#include "common/accel/traverse_cwbvh.h"

namespace pt {

/// A node as five 16-byte loads.
struct CwbvhWords {
  uint4 part[5];

  __device__ std::uint32_t child_base() const { return part[1].z; }
  __device__ std::uint32_t triangle_base() const { return part[1].w; }
  __device__ std::uint32_t inner_mask() const { return part[0].w & 0xffu; }
  __device__ std::uint32_t leaf_mask() const { return part[1].x & 0xffu; }
  __device__ std::uint32_t pair_mask() const { return part[1].y & 0xffu; }
};

__device__ inline CwbvhWords load_cwbvh_words(const CwbvhNode* node) {
  CwbvhWords words;
  PT_UNROLL(5)
  for (int i = 0; i < 5; ++i) words.part[i] = __ldg(reinterpret_cast<const uint4*>(node) + i);
  return words;
}

/// Loads only the words with the masks and bases.
__device__ inline CwbvhWords load_cwbvh_masks(const CwbvhNode* node) {
  const auto* part = reinterpret_cast<const uint4*>(node);
  return {{__ldg(part), __ldg(part + 1)}};
}

inline constexpr float byte_bias = 256.0f;

/// In place of cwbvh_origin_tolerance: the distance of the grid's origin is at most that of a plane
/// and 255 steps, so its rounding errors are in these two.
inline constexpr float biased_grid_tolerance = cwbvh_grid_tolerance + 0.5f / 4096.0f;
inline constexpr float biased_slab_tolerance = slab_tolerance + 8.0f * half_ulp;

/// bias + a byte of one of the two children in a word, one instruction on another pipe than minima
/// and shifts. `plane` is one of NearPlanes, or its far_plane.
template <bool second>
__device__ inline float biased_byte(std::uint32_t plane, std::uint32_t word) {
  constexpr std::uint32_t bias = 0x43800000u;
  return __uint_as_float(second ? __dp2a_hi(plane, word, bias) : __dp2a_lo(plane, word, bias));
}

/// What picks the low or the high plane of each child of a word, by axis: that where a ray enters.
struct NearPlanes {
  std::uint32_t x, y, z;
};

__device__ inline NearPlanes select_near_planes(const Vec3& inverse) {
  constexpr std::uint32_t low = 0x8000u, high = 0x80000000u;
  return {inverse.x < 0.0f ? high : low, inverse.y < 0.0f ? high : low,
          inverse.z < 0.0f ? high : low};
}

/// Where it leaves.
__device__ inline std::uint32_t far_plane(std::uint32_t near_plane) {
  return near_plane ^ 0x80008000u;
}

/// As CwbvhAxis, for biased bytes.
struct BiasedAxis {
  float step, near, far;
  std::uint32_t near_plane, far_plane;
};

__device__ inline BiasedAxis make_biased_axis(float grid_origin, std::uint32_t packed, float origin,
                                              float inverse, std::uint32_t near_plane) {
  const float step = unpack_cwbvh_step(packed) * inverse;
  const float base = (grid_origin - origin) * inverse;
  const float biased = __fmaf_rn(step, -byte_bias, base);
  return {step, __fmaf_rn(fabsf(step), -biased_grid_tolerance, biased),
          __fmaf_rn(fabsf(step), biased_grid_tolerance, biased), near_plane, far_plane(near_plane)};
}

/// Shifts into `misses` whether the ray misses the first or second child of the words x, y, z.
template <bool second>
__device__ inline void shift_in_miss(std::uint32_t x, std::uint32_t y, std::uint32_t z,
                                     const BiasedAxis (&axis)[3], int t_max,
                                     std::uint32_t& misses) {
  const auto near_of = [](std::uint32_t word, const BiasedAxis& a) {
    return __float_as_int(__fmaf_rn(biased_byte<second>(a.near_plane, word), a.step, a.near));
  };
  const auto far_of = [](std::uint32_t word, const BiasedAxis& a) {
    return __float_as_int(__fmaf_rn(biased_byte<second>(a.far_plane, word), a.step, a.far));
  };
  const int near =  // no less than 0
      __vimax3_s32_relu(near_of(x, axis[0]), near_of(y, axis[1]), near_of(z, axis[2]));
  const int far =
      __vimin3_s32(far_of(x, axis[0]), far_of(y, axis[1]), min(far_of(z, axis[2]), t_max));
  const float room =
      __fmaf_rn(__int_as_float(far), 1.0f + biased_slab_tolerance, -__int_as_float(near));
  misses = __funnelshift_l(__float_as_uint(room), misses, 1);
}

/// Bit s is clear when the ray meets the box in slot s at a distance of 0..t_max; slots without a
/// child may be clear, too. Bits 8..31 are clear. `planes` is select_near_planes(inverse).
__device__ inline std::uint32_t missed_slots(const CwbvhWords& node, const Vec3& origin,
                                             const Vec3& inverse, const NearPlanes& planes,
                                             float t_max) {
  const uint4 a = node.part[0], b = node.part[1];
  const BiasedAxis axis[3] = {
      make_biased_axis(__uint_as_float(a.x), a.w, origin.x, inverse.x, planes.x),
      make_biased_axis(__uint_as_float(a.y), b.x, origin.y, inverse.y, planes.y),
      make_biased_axis(__uint_as_float(a.z), b.y, origin.z, inverse.z, planes.z)};
  const uint4 x = node.part[2], y = node.part[3], z = node.part[4];
  const int end = __float_as_int(t_max);
  std::uint32_t misses = 0;
  shift_in_miss<true>(x.w, y.w, z.w, axis, end, misses);
  shift_in_miss<false>(x.w, y.w, z.w, axis, end, misses);
  shift_in_miss<true>(x.z, y.z, z.z, axis, end, misses);
  shift_in_miss<false>(x.z, y.z, z.z, axis, end, misses);
  shift_in_miss<true>(x.y, y.y, z.y, axis, end, misses);
  shift_in_miss<false>(x.y, y.y, z.y, axis, end, misses);
  shift_in_miss<true>(x.x, y.x, z.x, axis, end, misses);
  shift_in_miss<false>(x.x, y.x, z.x, axis, end, misses);
  return misses;
}

}  // namespace pt
