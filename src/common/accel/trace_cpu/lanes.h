// Four or eight floats at once by AVX2, and the triangle test for any number of lanes. Code for any
// number of lanes uses these names; sums and products are the compiler's operators. PT_LANES is the
// processor for which such functions, and all that call them, are compiled.
#pragma once

#ifdef __x86_64__
#include <immintrin.h>

#include <cstdint>

#define PT_AVX2 __attribute__((target("avx2,bmi,bmi2,popcnt")))
#ifndef PT_LANES
#define PT_LANES PT_AVX2
#endif

namespace pt {

struct Lanes4 {
  using Float = __m128;
  using Mask = __m128;
  static constexpr std::uint32_t every_bit = 0xf;

  PT_AVX2 static Float all(float x) { return _mm_set1_ps(x); }
  /// The smaller, or `b` where one is NaN; likewise the larger.
  PT_AVX2 static Float least(Float a, Float b) { return _mm_min_ps(a, b); }
  PT_AVX2 static Float most(Float a, Float b) { return _mm_max_ps(a, b); }
  PT_AVX2 static Mask less(Float a, Float b) { return _mm_cmplt_ps(a, b); }
  PT_AVX2 static Mask less_equal(Float a, Float b) { return _mm_cmple_ps(a, b); }
  PT_AVX2 static Mask both(Mask a, Mask b) { return _mm_and_ps(a, b); }
  PT_AVX2 static Mask but_not(Mask a, Mask b) { return _mm_andnot_ps(b, a); }
  /// Bit k is lane k's.
  PT_AVX2 static std::uint32_t bits(Mask a) {
    return static_cast<std::uint32_t>(_mm_movemask_ps(a));
  }

  /// As the functions in platform.h.
  PT_AVX2 static Float difference_of_products(Float a, Float b, Float c, Float d) {
    return _mm256_cvtpd_ps(_mm256_cvtps_pd(a) * _mm256_cvtps_pd(b) -
                           _mm256_cvtps_pd(c) * _mm256_cvtps_pd(d));
  }
  PT_AVX2 static Float sum_of_products(Float a, Float b, Float c, Float d, Float e, Float f) {
    return _mm256_cvtpd_ps(_mm256_cvtps_pd(a) * _mm256_cvtps_pd(b) +
                           _mm256_cvtps_pd(c) * _mm256_cvtps_pd(d) +
                           _mm256_cvtps_pd(e) * _mm256_cvtps_pd(f));
  }
};

struct Lanes8 {
  using Float = __m256;
  using Int = __m256i;
  using Mask = __m256;
  static constexpr std::uint32_t count = 8, every_bit = 0xff;

  PT_AVX2 static Float all(float x) { return _mm256_set1_ps(x); }
  PT_AVX2 static Int all_int(std::uint32_t x) { return _mm256_set1_epi32(static_cast<int>(x)); }
  PT_AVX2 static Float load(const float* p) { return _mm256_load_ps(p); }
  PT_AVX2 static void store(float* p, Float x) { _mm256_store_ps(p, x); }
  PT_AVX2 static void store(std::uint32_t* p, Int x) {
    _mm256_store_si256(reinterpret_cast<__m256i*>(p), x);
  }

  PT_AVX2 static Float least(Float a, Float b) { return _mm256_min_ps(a, b); }
  PT_AVX2 static Float most(Float a, Float b) { return _mm256_max_ps(a, b); }
  PT_AVX2 static Float square_root(Float a) { return _mm256_sqrt_ps(a); }
  PT_AVX2 static Float absolute(Float a) { return _mm256_andnot_ps(all(-0.0f), a); }
  PT_AVX2 static Float negative(Float a) { return _mm256_xor_ps(all(-0.0f), a); }
  /// 1 with the sign of a.
  PT_AVX2 static Float sign(Float a) {
    return _mm256_or_ps(_mm256_and_ps(all(-0.0f), a), all(1.0f));
  }

  PT_AVX2 static Mask less(Float a, Float b) { return _mm256_cmp_ps(a, b, _CMP_LT_OQ); }
  PT_AVX2 static Mask less_equal(Float a, Float b) { return _mm256_cmp_ps(a, b, _CMP_LE_OQ); }
  PT_AVX2 static Mask equal(Float a, Float b) { return _mm256_cmp_ps(a, b, _CMP_EQ_OQ); }
  PT_AVX2 static Mask less_int(Int a, Int b) {  // without sign: a is not the larger, nor equal
    return but_not(every_lane(),
                   _mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_max_epu32(a, b), a)));
  }
  PT_AVX2 static Mask no_lane() { return _mm256_setzero_ps(); }
  PT_AVX2 static Mask every_lane() { return _mm256_castsi256_ps(_mm256_set1_epi32(-1)); }
  PT_AVX2 static Mask both(Mask a, Mask b) { return _mm256_and_ps(a, b); }
  PT_AVX2 static Mask either(Mask a, Mask b) { return _mm256_or_ps(a, b); }
  PT_AVX2 static Mask but_not(Mask a, Mask b) { return _mm256_andnot_ps(b, a); }
  PT_AVX2 static std::uint32_t bits(Mask a) {
    return static_cast<std::uint32_t>(_mm256_movemask_ps(a));
  }
  /// The lanes whose sign is not set, and their bits.
  PT_AVX2 static Mask without_sign(Float a) { return but_not(every_lane(), copied_sign(a)); }
  PT_AVX2 static std::uint32_t bits_without_sign(Float a) { return bits(a) ^ every_bit; }
  PT_AVX2 static Float select(Mask m, Float a, Float b) { return _mm256_blendv_ps(b, a, m); }
  PT_AVX2 static Int select(Mask m, Int a, Int b) {
    return _mm256_blendv_epi8(b, a, _mm256_castps_si256(m));
  }

  PT_AVX2 static Float difference_of_products(Float a, Float b, Float c, Float d) {
    return join(Lanes4::difference_of_products(low(a), low(b), low(c), low(d)),
                Lanes4::difference_of_products(high(a), high(b), high(c), high(d)));
  }
  PT_AVX2 static Float sum_of_products(Float a, Float b, Float c, Float d, Float e, Float f) {
    return join(Lanes4::sum_of_products(low(a), low(b), low(c), low(d), low(e), low(f)),
                Lanes4::sum_of_products(high(a), high(b), high(c), high(d), high(e), high(f)));
  }

 private:
  PT_AVX2 static Mask copied_sign(Float a) {
    return _mm256_castsi256_ps(_mm256_srai_epi32(_mm256_castps_si256(a), 31));
  }
  PT_AVX2 static __m128 low(Float a) { return _mm256_castps256_ps128(a); }
  PT_AVX2 static __m128 high(Float a) { return _mm256_extractf128_ps(a, 1); }
  PT_AVX2 static Float join(__m128 a, __m128 b) { return _mm256_set_m128(b, a); }
};

/// Which lanes hit their triangle at t, t_min < t <= t_max, and that t. `x`, `y` and `depth` are
/// its projected vertices, `inverse` is TriangleRay's. Each lane executes the operations of
/// intersect_triangle (geometry/triangle.h) in their order and without contraction, so the hits
/// have the same bits.
template <class L>
PT_LANES inline typename L::Mask meet_projected(const typename L::Float (&x)[3],
                                                const typename L::Float (&y)[3],
                                                const typename L::Float (&depth)[3],
                                                typename L::Float inverse, typename L::Float t_min,
                                                typename L::Float t_max, typename L::Float& t) {
  using Float = typename L::Float;
  // Rounded differences of exact products.
  const Float u = L::difference_of_products(x[2], y[1], y[2], x[1]);
  const Float v = L::difference_of_products(x[0], y[2], y[0], x[2]);
  const Float w = L::difference_of_products(x[1], y[0], y[1], x[0]);
  const Float zero = L::all(0.0f);
  const Float least = L::least(u, L::least(v, w)), most = L::most(u, L::most(v, w));
  const typename L::Mask missed = L::both(L::less(least, zero), L::less(zero, most));
  t = zero;
  if (L::bits(missed) == L::every_bit) return L::but_not(missed, missed);
  const Float sum = L::sum_of_products(u, depth[0], v, depth[1], w, depth[2]);
  t = sum * (L::all(1.0f) / (u + v + w)) * inverse;
  return L::but_not(L::both(L::less(t_min, t), L::less_equal(t, t_max)), missed);
}

}  // namespace pt

#endif
