#include "common/sampling/draw_block.h"

#ifdef __x86_64__
#include <immintrin.h>
#endif

namespace pt {
namespace {

#ifdef __x86_64__
#define PT_AVX2 __attribute__((target("avx2")))

struct Halves {
  __m256i low, high;
};

// The 64 bits of each lane's product.
PT_AVX2 inline Halves multiply(__m256i a, std::uint32_t b) {
  constexpr int odd_lanes = 0xaa;
  const __m256i factor = _mm256_set1_epi32(static_cast<int>(b));
  const __m256i even = _mm256_mul_epu32(a, factor);
  const __m256i odd = _mm256_mul_epu32(_mm256_srli_epi64(a, 32), factor);
  return {_mm256_blend_epi32(even, _mm256_slli_epi64(odd, 32), odd_lanes),
          _mm256_blend_epi32(_mm256_srli_epi64(even, 32), odd, odd_lanes)};
}

// philox4x32_10 and to_unit_float of eight names, from `first` on.
PT_AVX2 void draw_eight(std::uint64_t seed, const DrawNames& names, std::uint32_t first,
                        DrawnBlock& drawn) {
  const auto load = [first](const std::uint32_t* p) PT_AVX2 {
    return _mm256_load_si256(reinterpret_cast<const __m256i*>(p + first));
  };
  __m256i x = load(names.block), y = _mm256_setzero_si256();
  __m256i z = load(names.pixel), w = load(names.sample);
  auto key0 = static_cast<std::uint32_t>(seed), key1 = static_cast<std::uint32_t>(seed >> 32);
  for (int round = 0; round < 10; ++round) {
    const Halves p0 = multiply(x, 0xD2511F53u), p1 = multiply(z, 0xCD9E8D57u);
    const __m256i k0 = _mm256_set1_epi32(static_cast<int>(key0));
    const __m256i k1 = _mm256_set1_epi32(static_cast<int>(key1));
    x = _mm256_xor_si256(_mm256_xor_si256(p1.high, y), k0), y = p1.low;
    z = _mm256_xor_si256(_mm256_xor_si256(p0.high, w), k1), w = p0.low;
    key0 += 0x9E3779B9u;
    key1 += 0xBB67AE85u;
  }
  const __m256i bits[4] = {x, y, z, w};
  for (int k = 0; k < 4; ++k) {
    const __m256 whole = _mm256_cvtepi32_ps(_mm256_srli_epi32(bits[k], 8));
    _mm256_store_ps(&drawn.u[k][first], _mm256_mul_ps(whole, _mm256_set1_ps(half_ulp)));
  }
}

const bool draws_eight = __builtin_cpu_supports("avx2") != 0;
#endif

}  // namespace

void draw_block(std::uint64_t seed, const DrawNames& names, std::uint32_t count,
                DrawnBlock& drawn) {
#ifdef __x86_64__
  if (draws_eight) {
    for (std::uint32_t first = 0; first < count; first += 8) draw_eight(seed, names, first, drawn);
    return;
  }
#endif
  for (std::uint32_t i = 0; i < count; ++i) {
    PhiloxSource::Stream stream{seed, names.pixel[i], names.sample[i]};
    drawn.set(i, stream.draw(names.block[i]));
  }
}

}  // namespace pt
