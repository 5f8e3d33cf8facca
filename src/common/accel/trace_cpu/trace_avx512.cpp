// Blocks of rays by AVX-512. In the wide tree a node's eight boxes are sixteen planes in one
// vector, and its triangles are gathered without a loop.
#include "common/accel/trace_cpu/lanes_avx512.h"
// clang-format off: behind it
#include "common/accel/trace_cpu/traverse_brute_lanes.h"
#include "common/accel/trace_cpu/traverse_cwbvh_turns.h"
// clang-format on

namespace pt {

#ifdef __x86_64__

namespace {

/// Lanes8 with eight doubles at once.
struct Lanes8By512 : Lanes8 {
  PT_LANES static Float difference_of_products(Float a, Float b, Float c, Float d) {
    return _mm512_cvtpd_ps(_mm512_cvtps_pd(a) * _mm512_cvtps_pd(b) -
                           _mm512_cvtps_pd(c) * _mm512_cvtps_pd(d));
  }
  PT_LANES static Float sum_of_products(Float a, Float b, Float c, Float d, Float e, Float f) {
    return _mm512_cvtpd_ps(_mm512_cvtps_pd(a) * _mm512_cvtps_pd(b) +
                           _mm512_cvtps_pd(c) * _mm512_cvtps_pd(d) +
                           _mm512_cvtps_pd(e) * _mm512_cvtps_pd(f));
  }
};

/// Puts the planes of the slots where the ray enters before those where it leaves: [octant][axis].
struct PlaneOrders {
  alignas(64) std::uint8_t of[8][3][16];
};
constexpr PlaneOrders plane_orders = [] {
  PlaneOrders orders{};
  for (std::uint32_t octant = 0; octant < 8; ++octant) {
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      for (std::uint32_t k = 0; k < 16; ++k) {
        const std::uint32_t leaves = k / 8 ^ (octant >> axis & 1u);
        orders.of[octant][axis][k] = static_cast<std::uint8_t>(2 * (k % 8) + leaves);
      }
    }
  }
  return orders;
}();

/// Along axis i: steps, and where the grid begins, of planes where the ray enters and of those
/// where it leaves, negative.
template <int i>
PT_LANES inline __m512 planes_along(const CwbvhNode& node, std::uint32_t octant, __m256 steps,
                                    __m256 bases) {
  const __m512i lanes = _mm512_setr_epi32(i, i, i, i, i, i, i, i, 4 + i, 4 + i, 4 + i, 4 + i, 4 + i,
                                          4 + i, 4 + i, 4 + i);
  const __m128i planes = _mm_shuffle_epi8(
      _mm_load_si128(reinterpret_cast<const __m128i*>(node.planes[i])),
      _mm_load_si128(reinterpret_cast<const __m128i*>(plane_orders.of[octant][i])));
  const __m512 q = _mm512_cvtepi32_ps(_mm512_cvtepu8_epi32(planes));
  return q * _mm512_permutexvar_ps(lanes, _mm512_castps256_ps512(steps)) +
         _mm512_permutexvar_ps(lanes, _mm512_castps256_ps512(bases));
}

struct TurnsByAvx512 {
  using Lanes = Lanes8By512;

  /// Distances where the ray leaves are kept with the other sign: so all are maxima.
  PT_LANES static std::uint32_t meet_node(const CwbvhNode& node, const TurnRay& ray,
                                          std::uint32_t octant) {
    const __m128 sign = _mm_set1_ps(-0.0f);
    const __m256 upper_sign = _mm256_setr_ps(0.0f, 0.0f, 0.0f, 0.0f, -0.0f, -0.0f, -0.0f, -0.0f);
    const __m128 inverse = _mm_load_ps(ray.inverse);
    const __m128 packed = _mm_loadu_ps(reinterpret_cast<const float*>(node.packed));
    const __m128 step_bits = _mm_castsi128_ps(_mm_setr_epi32(-256, -256, -256, 0));
    const __m128 step = _mm_and_ps(packed, step_bits) * inverse;
    const __m128 base = (_mm_loadu_ps(&node.origin.x) - _mm_loadu_ps(ray.origin)) * inverse;
    const __m128 slack = _mm_andnot_ps(sign, base) * _mm_set1_ps(cwbvh_origin_tolerance) +
                         _mm_andnot_ps(sign, step) * _mm_set1_ps(cwbvh_grid_tolerance);
    const __m256 steps = _mm256_xor_ps(_mm256_broadcast_f32x4(step), upper_sign);
    const __m256 bases =
        _mm256_xor_ps(_mm256_broadcast_f32x4(base), upper_sign) - _mm256_broadcast_f32x4(slack);
    // As max_number: the second operand where the first one is NaN.
    __m512 t = _mm512_maskz_mov_ps(0xff00, _mm512_set1_ps(-ray.t_max));
    t = _mm512_max_ps(planes_along<0>(node, octant, steps, bases), t);
    t = _mm512_max_ps(planes_along<1>(node, octant, steps, bases), t);
    t = _mm512_max_ps(planes_along<2>(node, octant, steps, bases), t);
    const __m256 limit = _mm512_extractf32x8_ps(t, 1) * _mm256_set1_ps(-(1.0f + slab_tolerance));
    return _mm256_cmp_ps_mask(_mm512_castps512_ps256(t), limit, _CMP_LE_OQ);
  }

  /// A bit for each triangle of a node's leaves, in their order, and of it those that are met.
  PT_LANES static void list_triangles(const CwbvhNode& node, std::uint32_t hits, std::uint32_t ray,
                                      TrianglePairs& pairs) {
    const auto by_slot = [](std::uint32_t first, std::uint32_t second) PT_LANES {
      return _pdep_u32(first, 0x5555u) | _pdep_u32(second, 0xaaaau);
    };
    const std::uint32_t leaves = node.leaf_mask(), seconds = node.pair_mask();
    const std::uint32_t met =
        _pext_u32(by_slot(hits & leaves, hits & seconds), by_slot(leaves, seconds));
    const __m512i slots =
        _mm512_add_epi32(_mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15),
                         _mm512_set1_epi32(static_cast<int>(node.triangle_base)));
    _mm512_storeu_si512(&pairs.slots[pairs.count],
                        _mm512_maskz_compress_epi32(static_cast<__mmask16>(met), slots));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(&pairs.rays[pairs.count]),
                     _mm_set1_epi8(static_cast<char>(ray)));
    pairs.count += static_cast<std::uint32_t>(__builtin_popcount(met));
  }
};

}  // namespace

const TreeBlock* tree_block_avx512() {
  return has_avx512() ? &TreeBlockBy<TurnsByAvx512>::functions : nullptr;
}

const BruteBlock* brute_block_avx512() { return has_avx512() ? &brute_block_by<Lanes16> : nullptr; }

#else

const TreeBlock* tree_block_avx512() { return nullptr; }

const BruteBlock* brute_block_avx512() { return nullptr; }

#endif

}  // namespace pt
