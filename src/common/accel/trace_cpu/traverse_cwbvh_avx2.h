// The wide tree's tests by AVX2, for x86 processors that have it: the eight boxes of a node at
// once, and four triangles. Each lane does the very operations of the plain tests, in their order
// and without contraction, so boxes are passed alike and hits are the same, bit for bit. The rest
// of the program needs no such processor: what is here is compiled for AVX2 function by function,
// and is called where has_avx2() says so.
#pragma once

#include "common/accel/trace_cpu/lanes.h"
#include "common/accel/traverse_cwbvh.h"

#ifdef __x86_64__

namespace pt {

/// As make_cwbvh_axis, of the three axes in as many lanes; the fourth holds zeros.
struct CwbvhAxesAvx2 {
  __m128 step, near, far;

  /// What lies behind three floats is read, too: it must be there.
  PT_AVX2 CwbvhAxesAvx2(const CwbvhNode& node, const float* ray_origin, const float* ray_inverse) {
    const __m128 step_bits = _mm_castsi128_ps(_mm_setr_epi32(-256, -256, -256, 0));
    const __m128 sign = _mm_set1_ps(-0.0f);
    const __m128 inverse = three(ray_inverse);
    const __m128 packed = _mm_loadu_ps(reinterpret_cast<const float*>(node.packed));
    step = _mm_and_ps(packed, step_bits) * inverse;
    const __m128 base = (three(&node.origin.x) - three(ray_origin)) * inverse;
    const __m128 slack = _mm_andnot_ps(sign, base) * _mm_set1_ps(cwbvh_origin_tolerance) +
                         _mm_andnot_ps(sign, step) * _mm_set1_ps(cwbvh_grid_tolerance);
    near = base - slack;
    far = base + slack;
  }

  /// Axis i's, eight times.
  template <int i>
  PT_AVX2 static __m256 axis(__m128 v) {
    return _mm256_permute_ps(_mm256_set_m128(v, v), i * 0x55);
  }

 private:
  PT_AVX2 static __m128 three(const float* p) {
    return _mm_blend_ps(_mm_loadu_ps(p), _mm_setzero_ps(), 8);
  }
};

/// Narrows [near, far] to where the ray is between the slots' planes of axis i.
template <int i>
PT_AVX2 inline void clip_to_axis(const CwbvhNode& node, std::uint32_t octant,
                                 const CwbvhAxesAvx2& axes, __m256& near, __m256& far) {
  // A slot's two planes are neighbours, the low one first: those where the ray enters become the
  // first eight bytes.
  const __m128i low_first = _mm_setr_epi8(0, 2, 4, 6, 8, 10, 12, 14, 1, 3, 5, 7, 9, 11, 13, 15);
  const __m128i negative = _mm_set1_epi8(static_cast<char>(octant >> i & 1u));
  const __m128i planes =
      _mm_shuffle_epi8(_mm_load_si128(reinterpret_cast<const __m128i*>(node.planes[i])),
                       _mm_xor_si128(low_first, negative));
  const __m256 enters = _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(planes));
  const __m256 leaves = _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_srli_si128(planes, 8)));
  const __m256 step = CwbvhAxesAvx2::axis<i>(axes.step);
  // As max_number and min_number: the second operand where the first one is NaN.
  near = _mm256_max_ps(enters * step + CwbvhAxesAvx2::axis<i>(axes.near), near);
  far = _mm256_min_ps(leaves * step + CwbvhAxesAvx2::axis<i>(axes.far), far);
}

/// As intersect_cwbvh_node, of CwbvhRay's members.
PT_AVX2 inline std::uint32_t intersect_cwbvh_node_avx2(const CwbvhNode& node, const float* origin,
                                                       const float* inverse, std::uint32_t octant,
                                                       float t_min, float t_max) {
  const CwbvhAxesAvx2 axes(node, origin, inverse);
  __m256 near = _mm256_set1_ps(t_min), far = _mm256_set1_ps(t_max);
  clip_to_axis<0>(node, octant, axes, near, far);
  clip_to_axis<1>(node, octant, axes, near, far);
  clip_to_axis<2>(node, octant, axes, near, far);
  const __m256 limit = far * _mm256_set1_ps(1.0f + slab_tolerance);
  const int met = _mm256_movemask_ps(_mm256_cmp_ps(near, limit, _CMP_LE_OQ));
  return static_cast<std::uint32_t>(met) & node.used_mask();
}
PT_AVX2 inline std::uint32_t intersect_cwbvh_node_avx2(const CwbvhNode& node, const CwbvhRay& ray,
                                                       float t_min, float t_max) {
  return intersect_cwbvh_node_avx2(node, &ray.origin.x, &ray.inverse.x, ray.octant, t_min, t_max);
}

/// Where a ray meets the triangles of four slots: bit k of the result says that it meets the k-th
/// one at t[k], t_min < t[k] <= t_max. As intersect_triangle.
PT_AVX2 inline std::uint32_t intersect_triangles_avx2(const TriangleRay& ray,
                                                      const Triangle* triangles,
                                                      const std::uint32_t (&slots)[4], float t_min,
                                                      float t_max, float (&t)[4]) {
  const __m128 origin[3] = {_mm_set1_ps(ray.origin.x), _mm_set1_ps(ray.origin.y),
                            _mm_set1_ps(ray.origin.z)};
  // Selected without branches, which would be guessed wrong where rays take turns.
  const __m128i axis = _mm_set1_epi32(static_cast<int>(ray.axis));
  const __m128 is_y = _mm_castsi128_ps(_mm_cmpeq_epi32(axis, _mm_set1_epi32(1)));
  const __m128 is_z = _mm_castsi128_ps(_mm_cmpeq_epi32(axis, _mm_set1_epi32(2)));
  __m128 x[3], y[3], depth[3];  // of the vertices
  PT_UNROLL(3)
  for (int v = 0; v < 3; ++v) {
    __m128 p[4];
    PT_UNROLL(4)
    for (int k = 0; k < 4; ++k) {
      p[k] = _mm_load_ps(reinterpret_cast<const float*>(&triangles[slots[k]]) + 4 * v);
    }
    _MM_TRANSPOSE4_PS(p[0], p[1], p[2], p[3]);
    PT_UNROLL(3)
    for (int i = 0; i < 3; ++i) p[i] = _mm_sub_ps(p[i], origin[i]);
    x[v] = _mm_add_ps(_mm_mul_ps(_mm_set1_ps(ray.x_axis.x), p[0]),
                      _mm_add_ps(_mm_mul_ps(_mm_set1_ps(ray.x_axis.y), p[1]),
                                 _mm_mul_ps(_mm_set1_ps(ray.x_axis.z), p[2])));
    y[v] = _mm_add_ps(_mm_mul_ps(_mm_set1_ps(ray.y_axis.x), p[0]),
                      _mm_add_ps(_mm_mul_ps(_mm_set1_ps(ray.y_axis.y), p[1]),
                                 _mm_mul_ps(_mm_set1_ps(ray.y_axis.z), p[2])));
    depth[v] = _mm_blendv_ps(_mm_blendv_ps(p[0], p[1], is_y), p[2], is_z);
  }
  __m128 at;
  const __m128 met = meet_projected<Lanes4>(x, y, depth, _mm_set1_ps(ray.inverse),
                                            _mm_set1_ps(t_min), _mm_set1_ps(t_max), at);
  _mm_storeu_ps(t, at);
  return Lanes4::bits(met);
}

struct CwbvhTestsAvx2 {
  /// Without the copy, which would wait for its own stores.
  static const CwbvhNode& load(const CwbvhNode* node) { return *node; }
  PT_AVX2 static std::uint32_t node(const CwbvhNode& node, const CwbvhRay& ray, float t_min,
                                    float t_max) {
    return intersect_cwbvh_node_avx2(node, ray, t_min, t_max);
  }

  /// Four triangles at once, of as many leaves as that takes.
  template <class Query>
  PT_AVX2 static bool offer(const TriangleTree& tree, const TriangleRay& ray, CwbvhLeaf leaf,
                            CwbvhGroup& leaves, Query& query) {
    static_assert(!Query::has_masks);
    std::uint32_t slots[4];
    std::uint32_t count = 0;
    while (true) {
      slots[count++] = leaf.first;
      if (leaf.count > 1) slots[count++] = leaf.first + 1;
      if (count > 2 || !leaves.has_slots()) break;
      leaf = take_leaf(leaves);
    }
    for (std::uint32_t k = count; k < 4; ++k) slots[k] = slots[0];
    float t[4];
    std::uint32_t met =
        intersect_triangles_avx2(ray, tree.triangles, slots, query.t_min(), query.t_max(), t);
    for (met &= (1u << count) - 1u; met != 0; met &= met - 1) {
      const auto k = static_cast<std::uint32_t>(__builtin_ctz(met));
      if (query.offer(tree, t[k], slots[k], 0)) return true;
    }
    return false;
  }
};

/// `flatten`: what is inlined is compiled for AVX2, too.
template <bool instanced, class Query>
__attribute__((target("avx2,bmi,bmi2,popcnt"), flatten, noinline)) void traverse_cwbvh_avx2(
    const TriangleTree& tree, const Ray& ray, Query& query) {
  traverse_cwbvh_by<instanced, CwbvhTestsAvx2>(tree, ray, query);
}

}  // namespace pt

#endif
