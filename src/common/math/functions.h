// Functions that have the same polynomial, and so the same bits, on every device; fast division.
#pragma once

#include "common/platform/platform.h"

namespace pt {

struct SinCos {
  float sin, cos;
};

/// sin and cos of 2 pi u for u in [0, 1], absolute error below 3e-7. The libraries' versions differ
/// between CPU and GPU and reduce arguments that never come here.
PT_HD SinCos sincos_2pi(float u) {
  const float quadrant = floorf(fused_multiply_add(4.0f, u, 0.5f));
  const float r = fused_multiply_add(-0.25f, quadrant, u);  // exact; in [-1/8, 1/8] turns
  const float x = 6.28318530717958648f * r;
  const float x2 = x * x;
  // Taylor terms up to x^9 and x^8: the remainder at pi/4 is below 2e-9 and 3e-8.
  float s = fused_multiply_add(x2, 2.7557319e-6f, -1.9841270e-4f);
  s = fused_multiply_add(x2, s, 8.3333333e-3f);
  s = fused_multiply_add(x2, s, -1.6666667e-1f);
  s = fused_multiply_add(x * x2, s, x);
  float c = fused_multiply_add(x2, 2.4801587e-5f, -1.3888889e-3f);
  c = fused_multiply_add(x2, c, 4.1666667e-2f);
  c = fused_multiply_add(x2, c, -0.5f);
  c = fused_multiply_add(x2, c, 1.0f);
  const int q = static_cast<int>(quadrant) & 3;
  const float swapped_s = (q & 1) ? c : s;
  const float swapped_c = (q & 1) ? s : c;
  return {(q & 2) ? -swapped_s : swapped_s, ((q + 1) & 2) ? -swapped_c : swapped_c};
}

/// The inverse of the error function: x with erff(x) = y, |y| < 1; relative error 3e-7 (the
/// single-precision polynomials of Giles 2010, 'Approximating the erfinv function'). +-1 gives
/// about +-3.8.
PT_HD float erf_inverse(float y) {
  float w = -logf(fmaxf((1.0f - y) * (1.0f + y), 1e-7f));
  float p;
  if (w < 5.0f) {
    w -= 2.5f;
    p = 2.81022636e-08f;
    p = fused_multiply_add(p, w, 3.43273939e-07f);
    p = fused_multiply_add(p, w, -3.5233877e-06f);
    p = fused_multiply_add(p, w, -4.39150654e-06f);
    p = fused_multiply_add(p, w, 0.00021858087f);
    p = fused_multiply_add(p, w, -0.00125372503f);
    p = fused_multiply_add(p, w, -0.00417768164f);
    p = fused_multiply_add(p, w, 0.246640727f);
    p = fused_multiply_add(p, w, 1.50140941f);
  } else {
    w = sqrtf(w) - 3.0f;
    p = -0.000200214257f;
    p = fused_multiply_add(p, w, 0.000100950558f);
    p = fused_multiply_add(p, w, 0.00134934322f);
    p = fused_multiply_add(p, w, -0.00367342844f);
    p = fused_multiply_add(p, w, 0.00573950773f);
    p = fused_multiply_add(p, w, -0.0076224613f);
    p = fused_multiply_add(p, w, 0.00943887047f);
    p = fused_multiply_add(p, w, 1.00167406f);
    p = fused_multiply_add(p, w, 2.83297682f);
  }
  return p * y;
}

/// Divides numbers below 2^31 by a divisor known only at run time, 1 <= divisor < 2^31, by one
/// multiplication and a shift (Granlund and Montgomery 1994, 'Division by Invariant Integers using
/// Multiplication').
class FastDivider {
 public:
  FastDivider() = default;
  explicit FastDivider(std::uint32_t divisor) : divisor_(divisor) {
    while ((std::uint64_t{1} << shift_) < divisor) ++shift_;
    multiplier_ = ((std::uint64_t{1} << (31 + shift_)) + divisor - 1) / divisor;
  }

  bool operator==(const FastDivider&) const = default;

  PT_HD std::uint32_t divisor() const { return divisor_; }
  PT_HD std::uint32_t quotient(std::uint32_t n) const {
    return static_cast<std::uint32_t>((n * multiplier_) >> (31 + shift_));
  }

 private:
  std::uint64_t multiplier_ = std::uint64_t{1} << 31;  // at most 2^32: n * multiplier_ < 2^63
  std::uint32_t divisor_ = 1;
  std::uint32_t shift_ = 0;
};

}  // namespace pt
