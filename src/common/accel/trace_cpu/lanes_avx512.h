// Sixteen floats at once by AVX-512, as lanes.h has eight. To be included before it.
#pragma once

#ifdef __x86_64__
#define PT_LANES __attribute__((target("avx512f,avx512dq,avx512vl,bmi,bmi2,popcnt")))

#include "common/accel/trace_cpu/lanes.h"

// GCC 12 takes its own intrinsics' undefined vectors for a mistake (GCC bug 105593).
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

namespace pt {

inline bool has_avx512() {
  static const bool has = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                          __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("bmi") &&
                          __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("popcnt");
  return has;
}

struct Lanes16 {
  using Float = __m512;
  using Int = __m512i;
  using Mask = __mmask16;
  static constexpr std::uint32_t count = 16, every_bit = 0xffff;

  PT_LANES static Float all(float x) { return _mm512_set1_ps(x); }
  PT_LANES static Int all_int(std::uint32_t x) { return _mm512_set1_epi32(static_cast<int>(x)); }
  PT_LANES static Float load(const float* p) { return _mm512_load_ps(p); }
  PT_LANES static void store(float* p, Float x) { _mm512_store_ps(p, x); }
  PT_LANES static void store(std::uint32_t* p, Int x) { _mm512_store_si512(p, x); }

  PT_LANES static Float least(Float a, Float b) { return _mm512_min_ps(a, b); }
  PT_LANES static Float most(Float a, Float b) { return _mm512_max_ps(a, b); }
  PT_LANES static Float square_root(Float a) { return _mm512_sqrt_ps(a); }
  PT_LANES static Float absolute(Float a) { return _mm512_andnot_ps(all(-0.0f), a); }
  PT_LANES static Float negative(Float a) { return _mm512_xor_ps(all(-0.0f), a); }
  PT_LANES static Float sign(Float a) {
    return _mm512_or_ps(_mm512_and_ps(all(-0.0f), a), all(1.0f));
  }

  PT_LANES static Mask less(Float a, Float b) { return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ); }
  PT_LANES static Mask less_equal(Float a, Float b) { return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ); }
  PT_LANES static Mask equal(Float a, Float b) { return _mm512_cmp_ps_mask(a, b, _CMP_EQ_OQ); }
  PT_LANES static Mask less_int(Int a, Int b) { return _mm512_cmplt_epu32_mask(a, b); }
  PT_LANES static Mask no_lane() { return 0; }
  PT_LANES static Mask every_lane() { return every_bit; }
  PT_LANES static Mask both(Mask a, Mask b) { return a & b; }
  PT_LANES static Mask either(Mask a, Mask b) { return a | b; }
  PT_LANES static Mask but_not(Mask a, Mask b) { return static_cast<Mask>(a & ~b); }
  PT_LANES static std::uint32_t bits(Mask a) { return a; }
  PT_LANES static Mask without_sign(Float a) {
    return static_cast<Mask>(~_mm512_movepi32_mask(_mm512_castps_si512(a)));
  }
  PT_LANES static std::uint32_t bits_without_sign(Float a) { return without_sign(a); }
  PT_LANES static Float select(Mask m, Float a, Float b) { return _mm512_mask_blend_ps(m, b, a); }
  PT_LANES static Int select(Mask m, Int a, Int b) { return _mm512_mask_blend_epi32(m, b, a); }

  PT_LANES static Float difference_of_products(Float a, Float b, Float c, Float d) {
    return join(difference(low(a), low(b), low(c), low(d)),
                difference(high(a), high(b), high(c), high(d)));
  }
  PT_LANES static Float sum_of_products(Float a, Float b, Float c, Float d, Float e, Float f) {
    return join(sum(low(a), low(b), low(c), low(d), low(e), low(f)),
                sum(high(a), high(b), high(c), high(d), high(e), high(f)));
  }

 private:
  PT_LANES static __m256 difference(__m256 a, __m256 b, __m256 c, __m256 d) {
    return _mm512_cvtpd_ps(_mm512_cvtps_pd(a) * _mm512_cvtps_pd(b) -
                           _mm512_cvtps_pd(c) * _mm512_cvtps_pd(d));
  }
  PT_LANES static __m256 sum(__m256 a, __m256 b, __m256 c, __m256 d, __m256 e, __m256 f) {
    return _mm512_cvtpd_ps(_mm512_cvtps_pd(a) * _mm512_cvtps_pd(b) +
                           _mm512_cvtps_pd(c) * _mm512_cvtps_pd(d) +
                           _mm512_cvtps_pd(e) * _mm512_cvtps_pd(f));
  }
  PT_LANES static __m256 low(Float a) { return _mm512_castps512_ps256(a); }
  PT_LANES static __m256 high(Float a) { return _mm512_extractf32x8_ps(a, 1); }
  PT_LANES static Float join(__m256 a, __m256 b) {
    return _mm512_insertf32x8(_mm512_castps256_ps512(a), b, 1);
  }
};

}  // namespace pt

#endif
