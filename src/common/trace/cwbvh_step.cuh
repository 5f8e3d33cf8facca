// One step of the wide tree's traversal as the GPU does it fastest. The same test as
// intersect_cwbvh_node, in fewer instructions: the bytes of near and far planes are chosen by
// words, minima and maxima take three operands at once (as integers, whose order is that of floats
// that are not negative), and the children's bits are placed by shifts that wrap.
#pragma once

#include "common/accel/traverse_cwbvh.h"

namespace pt {

/// A node as five 16-byte loads.
struct CwbvhWords {
  uint4 part[5];
};

__device__ inline CwbvhWords load_cwbvh_words(const CwbvhNode* node) {
  CwbvhWords words;
  PT_UNROLL(5)
  for (int i = 0; i < 5; ++i) words.part[i] = __ldg(reinterpret_cast<const uint4*>(node) + i);
  return words;
}

/// A byte of a word, in one instruction; nvcc 13.0 makes three of the same in C++.
template <int byte>
__device__ inline float byte_to_float(std::uint32_t word) {
  float result;
  asm("{\n\t.reg .b32 q;\n\tbfe.u32 q, %1, %2, 8;\n\tcvt.rn.f32.u32 %0, q;\n\t}"
      : "=f"(result)
      : "r"(word), "n"(8 * byte));
  return result;
}

/// value << (amount mod 32).
__device__ inline std::uint32_t shift_left_wrapping(std::uint32_t value, std::uint32_t amount) {
  std::uint32_t result;
  asm("shf.l.wrap.b32 %0, 0, %1, %2;" : "=r"(result) : "r"(value), "r"(amount));
  return result;
}

/// The words of one half of a node's children: four bytes each.
struct CwbvhHalf {
  std::uint32_t meta;
  std::uint32_t near_x, near_y, near_z, far_x, far_y, far_z;
};

template <int child>
__device__ inline void add_cwbvh_child(const CwbvhHalf& half, std::uint32_t bits,
                                       std::uint32_t places, const CwbvhAxis (&axis)[3],
                                       int t_min, int t_max, std::uint32_t& hits) {
  const auto distance = [](std::uint32_t q, float step, float base) {
    return __float_as_int(__fmaf_rn(byte_to_float<child>(q), step, base));
  };
  const int near_x = distance(half.near_x, axis[0].step, axis[0].near);
  const int near_y = distance(half.near_y, axis[1].step, axis[1].near);
  const int near_z = distance(half.near_z, axis[2].step, axis[2].near);
  const int far_x = distance(half.far_x, axis[0].step, axis[0].far);
  const int far_y = distance(half.far_y, axis[1].step, axis[1].far);
  const int far_z = distance(half.far_z, axis[2].step, axis[2].far);
  const int near = __vimax3_s32(near_x, near_y, max(near_z, t_min));
  const int far = __vimin3_s32(far_x, far_y, min(far_z, t_max));
  const std::uint32_t bit = __byte_perm(bits, 0, 0x4440 | child);
  const std::uint32_t place = places >> (8 * child);
  if (near <= far) hits |= shift_left_wrapping(bit, place);
}

/// Four children: their bits of intersect_cwbvh_node are added to `hits`.
__device__ inline void add_cwbvh_half(const CwbvhHalf& half, std::uint32_t octant4,
                                      const CwbvhAxis (&axis)[3], int t_min, int t_max,
                                      std::uint32_t& hits) {
  const std::uint32_t inner = (half.meta & (half.meta << 1)) & 0x10101010u;
  const std::uint32_t octants = (inner >> 4) * 7u & octant4;  // of inner children
  const std::uint32_t places = half.meta ^ octants;
  const std::uint32_t bits = (half.meta >> 5) & 0x07070707u;
  add_cwbvh_child<0>(half, bits, places, axis, t_min, t_max, hits);
  add_cwbvh_child<1>(half, bits, places, axis, t_min, t_max, hits);
  add_cwbvh_child<2>(half, bits, places, axis, t_min, t_max, hits);
  add_cwbvh_child<3>(half, bits, places, axis, t_min, t_max, hits);
}

/// As intersect_cwbvh_node; 0 <= t_min. `octant4` has the ray's octant in each byte.
__device__ inline std::uint32_t intersect_cwbvh_words(const CwbvhWords& node, const Vec3& origin,
                                                      const Vec3& inverse, std::uint32_t octant4,
                                                      float t_min, float t_max) {
  const uint4 a = node.part[0], b = node.part[1], c = node.part[2], d = node.part[3],
              e = node.part[4];
  const CwbvhAxis axis[3] = {
      make_cwbvh_axis(__uint_as_float(a.x), a.w & 0xffu, origin.x, inverse.x),
      make_cwbvh_axis(__uint_as_float(a.y), a.w >> 8 & 0xffu, origin.y, inverse.y),
      make_cwbvh_axis(__uint_as_float(a.z), a.w >> 16 & 0xffu, origin.z, inverse.z)};
  const bool x = inverse.x < 0.0f, y = inverse.y < 0.0f, z = inverse.z < 0.0f;
  const CwbvhHalf first = {b.z,           x ? d.z : c.x, y ? e.x : c.z, z ? e.z : d.x,
                           x ? c.x : d.z, y ? c.z : e.x, z ? d.x : e.z};
  const CwbvhHalf second = {b.w,           x ? d.w : c.y, y ? e.y : c.w, z ? e.w : d.y,
                            x ? c.y : d.w, y ? c.w : e.y, z ? d.y : e.w};
  std::uint32_t hits = 0;
  add_cwbvh_half(first, octant4, axis, __float_as_int(t_min), __float_as_int(t_max), hits);
  add_cwbvh_half(second, octant4, axis, __float_as_int(t_min), __float_as_int(t_max), hits);
  return hits;
}

}  // namespace pt
