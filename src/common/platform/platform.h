// The one place that knows whether a file is compiled for the CPU or for CUDA.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "common/platform/half_float.h"

#define PT_PRAGMA(x) _Pragma(#x)

#ifdef __CUDACC__
#include <cuda.h>  // before GLM, which reads CUDA_VERSION
#include <cuda_runtime.h>
#define GLM_FORCE_CUDA
#define PT_HD __host__ __device__ inline
#define PT_NOINLINE __host__ __device__ __noinline__
// Code that a compiler would call if it were left to it: then a kernel would hand it the scene
// through local memory, which has cost up to 1.8 times the whole kernel.
#define PT_HD_IN_KERNEL __host__ __device__ __forceinline__
#define PT_HD_IN_LOOP PT_HD
#define PT_UNROLL(n) PT_PRAGMA(unroll n)
#else
#include "common/platform/platform_cpu.h"
#define PT_HD inline
#define PT_NOINLINE __attribute__((noinline))
#define PT_HD_IN_KERNEL inline
// Of a loop that is short: GCC calls it where a file has much code, and rays take a quarter longer.
#define PT_HD_IN_LOOP inline __attribute__((always_inline))
#define PT_UNROLL(n) PT_PRAGMA(GCC unroll n)
#endif

namespace pt {

/// Whether the file is compiled for CUDA.
#ifdef __CUDACC__
inline constexpr bool is_cuda_code = true;
#else
inline constexpr bool is_cuda_code = false;
#endif

/// Whether it is being compiled for a GPU, where pairs of halves (below) are computed by
/// instructions. A file for CUDA is also compiled for the CPU.
#ifdef __CUDA_ARCH__
inline constexpr bool runs_on_gpu = true;
#else
inline constexpr bool runs_on_gpu = false;
#endif
inline constexpr bool has_half_pairs = runs_on_gpu;

PT_HD std::uint32_t float_to_bits(float x) {
#ifdef __CUDA_ARCH__
  return __float_as_uint(x);
#else
  std::uint32_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  return bits;
#endif
}

PT_HD float bits_to_float(std::uint32_t bits) {
#ifdef __CUDA_ARCH__
  return __uint_as_float(bits);
#else
  float x;
  std::memcpy(&x, &bits, sizeof x);
  return x;
#endif
}

/// *p by 16-byte accesses, which the compiler does not make of a structure's members by itself.
template <class T>
PT_HD T load_wide(const T* p) {
#ifdef __CUDA_ARCH__
  static_assert(sizeof(T) % 16 == 0 && alignof(T) % 16 == 0);
  T value;
  PT_UNROLL(8)
  for (int i = 0; i < static_cast<int>(sizeof(T) / 16); ++i) {
    const uint4 part = reinterpret_cast<const uint4*>(p)[i];
    memcpy(reinterpret_cast<char*>(&value) + 16 * i, &part, 16);
  }
  return value;
#else
  return *p;
#endif
}

/// *p = value by 16-byte accesses.
template <class T>
PT_HD void store_wide(T* p, const T& value) {
#ifdef __CUDA_ARCH__
  static_assert(sizeof(T) % 16 == 0 && alignof(T) % 16 == 0);
  PT_UNROLL(8)
  for (int i = 0; i < static_cast<int>(sizeof(T) / 16); ++i) {
    uint4 part;
    memcpy(&part, reinterpret_cast<const char*>(&value) + 16 * i, 16);
    reinterpret_cast<uint4*>(p)[i] = part;
  }
#else
  *p = value;
#endif
}

/// An optimisation barrier: returns x, which the compiler takes for an unknown value. So it
/// computes again what it has computed from x before, instead of keeping that in registers.
PT_HD float optimization_barrier(float x) {
#ifdef __CUDA_ARCH__
  asm volatile("" : "+f"(x));
#endif
  return x;
}

/// The smaller, or `b` where `a` is NaN; `b` is a number. One instruction.
PT_HD float min_number(float a, float b) {
#ifdef __CUDA_ARCH__
  return fminf(a, b);
#else
  return a < b ? a : b;
#endif
}

/// The larger, or `b` where `a` is NaN; `b` is a number. One instruction.
PT_HD float max_number(float a, float b) {
#ifdef __CUDA_ARCH__
  return fmaxf(a, b);
#else
  return a > b ? a : b;
#endif
}

/// 1 / sqrt(x): within 2 ulp on CUDA, correctly rounded in two steps on the CPU.
PT_HD float inverse_sqrt(float x) {
#ifdef __CUDA_ARCH__
  return rsqrtf(x);
#else
  return 1.0f / std::sqrt(x);
#endif
}

/// inverse_sqrt for x >= 2^-126: three instructions fewer.
PT_HD float inverse_sqrt_of_normal(float x) {
#ifdef __CUDA_ARCH__
  float result;
  asm("rsqrt.approx.ftz.f32 %0, %1;" : "=f"(result) : "f"(x));
  return result;
#else
  return 1.0f / std::sqrt(x);
#endif
}

/// sqrt(x), 0 for x < 0: within 2 ulp on CUDA, where x below 2^-126 counts as 0, correctly rounded
/// on the CPU.
PT_HD float fast_sqrt(float x) {
#ifdef __CUDA_ARCH__
  return x >= 1.17549435e-38f ? x * inverse_sqrt_of_normal(x) : 0.0f;
#else
  return x > 0.0f ? std::sqrt(x) : 0.0f;
#endif
}

/// c ? a : b without a branch: both are computed, even if one is expensive.
PT_HD float select(bool c, float a, float b) {
#ifdef __CUDA_ARCH__
  float result;
  asm("{ .reg .pred p; setp.ne.u32 p, %3, 0; selp.f32 %0, %1, %2, p; }"
      : "=f"(result)
      : "f"(a), "f"(b), "r"(static_cast<std::uint32_t>(c)));
  return result;
#else
  return c ? a : b;
#endif
}

/// 1 / x: within 1 ulp on CUDA, where results or x below 2^-126 count as 0; rounded on the CPU.
PT_HD float approximate_inverse(float x) {
#ifdef __CUDA_ARCH__
  float result;
  asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(result) : "f"(x));
  return result;
#else
  return 1.0f / x;
#endif
}

/// a / b, rounded as the operator rounds it where the absolute values of a, b and the result are 0
/// or between 2^-100 and 2^100. Beyond, where the operator branches to slow code, the last bits may
/// differ; a divisor below 2^-126 counts as 0, one above 2^126 as infinite. Without branches other
/// things are computed meanwhile, and shading, which has hundreds of divisions, has less code.
PT_HD float divide(float a, float b) {
#ifdef __CUDA_ARCH__
  const float start = approximate_inverse(b);
  const float inverse = __fmaf_rn(start, __fmaf_rn(-b, start, 1.0f), start);
  float q = a * inverse;
  q = __fmaf_rn(inverse, __fmaf_rn(-b, q, a), q);
  q = __fmaf_rn(inverse, __fmaf_rn(-b, q, a), q);
  return q == q ? q : a * start;  // by 0, or by what is infinite
#else
  return a / b;
#endif
}

/// sqrt(x), rounded as sqrtf() rounds it, for x that is 0 or between 2^-100 and 2^100; likewise
/// without branches.
PT_HD float square_root(float x) {
#ifdef __CUDA_ARCH__
  const float inverse = inverse_sqrt_of_normal(x), root = x * inverse;
  const float result = __fmaf_rn(__fmaf_rn(-root, root, x), 0.5f * inverse, root);
  return fabsf(x) < 1.17549435e-38f ? 0.0f : result;
#else
  return std::sqrt(x);
#endif
}

/// a * b + c: one rounding on CUDA, two on the CPU, whose baseline has no such instruction. No
/// compiler fuses a product and a sum by itself: docs/design/bit_equality.md, 'Rounding'.
PT_HD float fused_multiply_add(float a, float b, float c) {
#ifdef __CUDA_ARCH__
  return __fmaf_rn(a, b, c);
#else
  return a * b + c;
#endif
}

/// a * b - c * d within 2 half ulps of the result, so that its sign is right and it is 0, never -0,
/// only where both products are equal (Kahan's algorithm; Jeannerod, Louvet and Muller 2013,
/// 'Further analysis of Kahan's algorithm for the accurate computation of 2 x 2 determinants'). On
/// the CPU doubles hold both products exactly.
PT_HD float difference_of_products(float a, float b, float c, float d) {
#ifdef __CUDA_ARCH__
  const float cd = c * d;
  return __fmaf_rn(a, b, -cd) + __fmaf_rn(-c, d, cd);
#else
  return static_cast<float>(static_cast<double>(a) * b - static_cast<double>(c) * d);
#endif
}

/// a * b + c * d + e * f with three roundings on CUDA, and one on the CPU.
PT_HD float sum_of_products(float a, float b, float c, float d, float e, float f) {
#ifdef __CUDA_ARCH__
  return __fmaf_rn(a, b, __fmaf_rn(c, d, e * f));
#else
  return static_cast<float>(static_cast<double>(a) * b + static_cast<double>(c) * d +
                            static_cast<double>(e) * f);
#endif
}

/// Whether one of three numbers is below 0 and one above. On CUDA they are compared as integers,
/// three at once: none may be -0, which difference_of_products never is.
PT_HD bool differ_in_sign(float a, float b, float c) {
#ifdef __CUDA_ARCH__
  const int i = __float_as_int(a), j = __float_as_int(b), k = __float_as_int(c);
  return (__vimin3_s32(i, j, k) < 0) & (__vimax3_s32(i, j, k) > 0);  // && makes bytes of both
#else
  const float least = a < b ? (a < c ? a : c) : (b < c ? b : c);
  const float most = a > b ? (a > c ? a : c) : (b > c ? b : c);
  return least < 0.0f && most > 0.0f;
#endif
}

/// (bits << 1) | sign of x: one instruction on CUDA.
PT_HD std::uint32_t shift_in_sign(std::uint32_t bits, float x) {
#ifdef __CUDA_ARCH__
  return __funnelshift_l(__float_as_uint(x), bits, 1);
#else
  return (bits << 1) | (float_to_bits(x) >> 31);
#endif
}

// Two numbers of half precision side by side in a word, for which CUDA has instructions.

/// Both rounded to the nearest half, `first` into the lower bits.
PT_HD std::uint32_t pack_halves(float first, float second) {
#ifdef __CUDA_ARCH__
  std::uint32_t pair;
  asm("cvt.rn.f16x2.f32 %0, %2, %1;" : "=r"(pair) : "f"(first), "f"(second));
  return pair;
#else
  return to_half(first) | static_cast<std::uint32_t>(to_half(second)) << 16;
#endif
}

/// a * b + c of both, rounded once.
PT_HD std::uint32_t multiply_add_halves(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
#ifdef __CUDA_ARCH__
  std::uint32_t pair;
  asm("fma.rn.f16x2 %0, %1, %2, %3;" : "=r"(pair) : "r"(a), "r"(b), "r"(c));
  return pair;
#else
  const auto fused = [&](int shift) -> std::uint32_t {
    const auto part = [&](std::uint32_t pair) {
      return from_half(static_cast<std::uint16_t>(pair >> shift));
    };
    return to_half(part(a) * part(b) + part(c));
  };
  return fused(0) | fused(16) << 16;
#endif
}

PT_HD std::uint32_t negate_halves(std::uint32_t pair) {
#ifdef __CUDA_ARCH__
  std::uint32_t negative;
  asm("neg.f16x2 %0, %1;" : "=r"(negative) : "r"(pair));
  return negative;
#else
  return pair ^ 0x80008000u;
#endif
}

/// The signs of the halves of a and then of b, from the lowest byte on: 0 or 255 each.
PT_HD std::uint32_t sign_bytes(std::uint32_t a, std::uint32_t b) {
#ifdef __CUDA_ARCH__
  std::uint32_t signs;
  asm("prmt.b32 %0, %1, %2, 0xfdb9;" : "=r"(signs) : "r"(a), "r"(b));
  return signs;
#else
  const auto bytes = [](std::uint32_t pair) {
    return (pair >> 15 & 1) * 0xffu | (pair >> 31) * 0xff00u;
  };
  return bytes(a) | bytes(b) << 16;
#endif
}

PT_HD int count_leading_zeros(std::uint32_t x) {
#ifdef __CUDA_ARCH__
  return __clz(static_cast<int>(x));
#else
  return x == 0 ? 32 : __builtin_clz(x);
#endif
}

PT_HD int count_bits(std::uint32_t x) {
#ifdef __CUDA_ARCH__
  return __popc(x);
#else
  return __builtin_popcount(x);
#endif
}

/// False, which the compiler does not know: a loop while it is true stays a loop, around which code
/// branches. What is rarely needed would else be executed by predicated instructions, always.
PT_HD bool is_never() {
#ifdef __CUDA_ARCH__
  unsigned lane;
  asm volatile("mov.u32 %0, %%laneid;" : "=r"(lane));
  return lane > 31;
#else
  return false;
#endif
}

PT_HD std::uint32_t min_integer(std::uint32_t a, std::uint32_t b) { return a < b ? a : b; }
PT_HD std::uint32_t max_integer(std::uint32_t a, std::uint32_t b) { return a < b ? b : a; }

/// The index of the highest bit that is set; x is not 0.
PT_HD std::uint32_t highest_bit(std::uint32_t x) {
#ifdef __CUDA_ARCH__
  std::uint32_t bit;
  asm("bfind.u32 %0, %1;" : "=r"(bit) : "r"(x));
  return bit;
#else
  return 31u - static_cast<std::uint32_t>(count_leading_zeros(x));
#endif
}

/// a * b: both words of it. On CUDA the shift of the 64 bits becomes an addition of 0, unless the
/// product is `split` by hand.
struct WideProduct {
  std::uint32_t low, high;
};
template <bool split>
PT_HD WideProduct multiply_wide(std::uint32_t a, std::uint32_t b) {
#ifdef __CUDA_ARCH__
  if constexpr (split) {
    WideProduct p;
    asm("{ .reg .b64 p; mul.wide.u32 p, %2, %3; mov.b64 {%0, %1}, p; }"
        : "=r"(p.low), "=r"(p.high)
        : "r"(a), "r"(b));
    return p;
  }
#endif
  const std::uint64_t p = std::uint64_t{a} * b;
  return {static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(p >> 32)};
}

/// Adds to a counter that other threads add to, and returns its former value.
PT_HD std::uint32_t atomic_fetch_add(std::uint32_t* counter, std::uint32_t amount) {
#ifdef __CUDA_ARCH__
  return atomicAdd(counter, amount);
#elif defined(__CUDACC__)
  const std::uint32_t before = *counter;  // host side of a .cu file: never called from threads
  *counter += amount;
  return before;
#else
  return std::atomic_ref<std::uint32_t>(*counter).fetch_add(amount, std::memory_order_relaxed);
#endif
}

/// Adds to a sum that other threads add to. On the host side of a .cu file: never from threads.
PT_HD void atomic_add(std::uint64_t* sum, std::uint64_t value) {
#ifdef __CUDA_ARCH__
  atomicAdd(reinterpret_cast<unsigned long long*>(sum), static_cast<unsigned long long>(value));
#elif defined(__CUDACC__)
  *sum += value;
#else
  std::atomic_ref<std::uint64_t>(*sum).fetch_add(value, std::memory_order_relaxed);
#endif
}

/// Adds 1 to counters[n - 1] where n lanes of a warp make this call together: once for all of them,
/// to the counters of the lowest lane. Nothing on the CPU, which has no warps.
PT_HD void count_active_lanes([[maybe_unused]] std::uint64_t (&counters)[32]) {
#ifdef __CUDA_ARCH__
  const unsigned active = __activemask();
  unsigned lower;
  asm("mov.u32 %0, %%lanemask_lt;" : "=r"(lower));
  if ((active & lower) != 0) return;
  atomicAdd(reinterpret_cast<unsigned long long*>(&counters[__popc(active) - 1]), 1ull);
#endif
}

#ifdef __CUDACC__
/// The least and the largest of a warp's values, by all of its threads.
__device__ inline std::uint32_t warp_min(std::uint32_t x) {
#if __CUDA_ARCH__ >= 800
  return __reduce_min_sync(0xffffffffu, x);
#else
  for (int step = 16; step > 0; step /= 2) x = min(x, __shfl_xor_sync(0xffffffffu, x, step));
  return x;
#endif
}
__device__ inline std::uint32_t warp_max(std::uint32_t x) {
#if __CUDA_ARCH__ >= 800
  return __reduce_max_sync(0xffffffffu, x);
#else
  for (int step = 16; step > 0; step /= 2) x = max(x, __shfl_xor_sync(0xffffffffu, x, step));
  return x;
#endif
}
#endif

/// The lowest bit becomes the highest.
PT_HD std::uint32_t reverse_bits(std::uint32_t x) {
#ifdef __CUDA_ARCH__
  return __brev(x);
#else
  x = (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
  x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
  x = (x & 0x0f0f0f0fu) << 4 | (x >> 4 & 0x0f0f0f0fu);
  x = (x & 0x00ff00ffu) << 8 | (x >> 8 & 0x00ff00ffu);
  return x << 16 | x >> 16;
#endif
}

}  // namespace pt
