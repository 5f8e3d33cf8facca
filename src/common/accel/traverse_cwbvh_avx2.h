// The wide tree's tests by AVX2, for x86 processors that have it: the eight boxes of a node at
// once, and four triangles. Each lane does the very operations of the plain tests, in their order
// and without contraction, so boxes are passed alike and hits are the same, bit for bit. The rest
// of the program needs no such processor: what is here is compiled for AVX2 function by function,
// and is called where has_avx2() says so.
#pragma once

#ifdef __x86_64__
#include <immintrin.h>

#include "common/accel/traverse_cwbvh.h"

#define PT_AVX2 __attribute__((target("avx2,bmi,bmi2,popcnt")))

namespace pt {

/// As intersect_cwbvh_node.
PT_AVX2 inline std::uint32_t intersect_cwbvh_node_avx2(const CwbvhNode& node, const CwbvhRay& ray,
                                                       float t_min, float t_max) {
  __m256 near = _mm256_set1_ps(t_min), far = _mm256_set1_ps(t_max);
  const __m128i low_byte = _mm_set1_epi16(0xff);
  PT_UNROLL(3)
  for (int i = 0; i < 3; ++i) {
    const CwbvhAxis axis =
        make_cwbvh_axis(node.origin[i], node.step(i), ray.origin[i], ray.inverse[i]);
    const __m256 step = _mm256_set1_ps(axis.step);
    // A slot's two planes are the bytes of a 16-bit word, the low one first.
    const __m128i planes = _mm_load_si128(reinterpret_cast<const __m128i*>(node.planes[i]));
    const int shift = ray.inverse[i] < 0.0f ? 8 : 0;
    const __m128i first = _mm_and_si128(_mm_srl_epi16(planes, _mm_cvtsi32_si128(shift)), low_byte);
    const __m128i second =
        _mm_and_si128(_mm_srl_epi16(planes, _mm_cvtsi32_si128(8 - shift)), low_byte);
    const __m256 enters = _mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(first));
    const __m256 leaves = _mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(second));
    // As max_number and min_number: the second operand where the first one is NaN.
    near =
        _mm256_max_ps(_mm256_add_ps(_mm256_mul_ps(enters, step), _mm256_set1_ps(axis.near)), near);
    far = _mm256_min_ps(_mm256_add_ps(_mm256_mul_ps(leaves, step), _mm256_set1_ps(axis.far)), far);
  }
  const __m256 limit = _mm256_mul_ps(far, _mm256_set1_ps(1.0f + slab_tolerance));
  const int met = _mm256_movemask_ps(_mm256_cmp_ps(near, limit, _CMP_LE_OQ));
  return static_cast<std::uint32_t>(met) & node.used_mask();
}

/// Where a ray meets the triangles of four slots: bit k of the result says that it meets the k-th
/// one at t[k], t_min < t[k] <= t_max. As intersect_triangle.
PT_AVX2 inline std::uint32_t intersect_triangles_avx2(const TriangleRay& ray,
                                                      const Triangle* triangles,
                                                      const std::uint32_t (&slots)[4], float t_min,
                                                      float t_max, float (&t)[4]) {
  const __m128 origin[3] = {_mm_set1_ps(ray.origin.x), _mm_set1_ps(ray.origin.y),
                            _mm_set1_ps(ray.origin.z)};
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
    depth[v] = ray.axis == 2 ? p[2] : ray.axis == 1 ? p[1] : p[0];
  }
  __m128 edge[3];  // u, v, w: rounded differences of exact products
  PT_UNROLL(3)
  for (int i = 0; i < 3; ++i) {
    const int a = (i + 2) % 3, b = (i + 1) % 3;
    const __m256d ab = _mm256_mul_pd(_mm256_cvtps_pd(x[a]), _mm256_cvtps_pd(y[b]));
    const __m256d ba = _mm256_mul_pd(_mm256_cvtps_pd(y[a]), _mm256_cvtps_pd(x[b]));
    edge[i] = _mm256_cvtpd_ps(_mm256_sub_pd(ab, ba));
  }
  const __m128 zero = _mm_setzero_ps();
  const __m128 least = _mm_min_ps(edge[0], _mm_min_ps(edge[1], edge[2]));
  const __m128 most = _mm_max_ps(edge[0], _mm_max_ps(edge[1], edge[2]));
  const __m128 missed = _mm_and_ps(_mm_cmplt_ps(least, zero), _mm_cmpgt_ps(most, zero));
  const int all_missed = _mm_movemask_ps(missed);
  if (all_missed == 0xf) return 0;
  const __m128 determinant = _mm_add_ps(_mm_add_ps(edge[0], edge[1]), edge[2]);
  __m256d sum = _mm256_mul_pd(_mm256_cvtps_pd(edge[0]), _mm256_cvtps_pd(depth[0]));
  PT_UNROLL(2)
  for (int i = 1; i < 3; ++i) {
    const __m256d next = _mm256_mul_pd(_mm256_cvtps_pd(edge[i]), _mm256_cvtps_pd(depth[i]));
    sum = _mm256_add_pd(sum, next);
  }
  const __m128 inverse = _mm_div_ps(_mm_set1_ps(1.0f), determinant);
  const __m128 at = _mm_mul_ps(_mm_mul_ps(_mm256_cvtpd_ps(sum), inverse), _mm_set1_ps(ray.inverse));
  _mm_storeu_ps(t, at);
  const __m128 in_range =
      _mm_and_ps(_mm_cmpgt_ps(at, _mm_set1_ps(t_min)), _mm_cmple_ps(at, _mm_set1_ps(t_max)));
  return static_cast<std::uint32_t>(_mm_movemask_ps(in_range) & ~all_missed);
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

#undef PT_AVX2
#endif
