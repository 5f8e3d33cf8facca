// Half precision (IEEE 754 binary16), of which the host knows only how to convert.
#pragma once

#include <cmath>
#include <cstdint>

namespace pt {

/// Half an ulp of a half, relative to the number.
inline constexpr double half_float_rounding = 0x1p-11;

/// The nearest, of two equally near the even one.
inline std::uint16_t to_half(double x) {
  const std::uint16_t sign = std::signbit(x) ? 0x8000 : 0;
  const double size = std::fabs(x);
  if (std::isnan(x)) return 0x7fff;           // as CUDA has it
  if (size >= 65520.0) return sign | 0x7c00;  // infinite
  int exponent = -14;                         // of numbers below the least normal one, too
  if (size >= 0x1p-14) exponent = std::ilogb(size);
  const double ulps = std::nearbyint(std::ldexp(size, 10 - exponent));  // up to 2048: carries
  return static_cast<std::uint16_t>(sign + (exponent + 14) * 1024 + static_cast<int>(ulps));
}

inline double from_half(std::uint16_t half) {
  const int exponent = half >> 10 & 31, fraction = half & 1023;
  double size = std::ldexp(fraction, -24);
  if (exponent == 31) size = fraction != 0 ? NAN : HUGE_VAL;
  if (exponent > 0 && exponent < 31) size = std::ldexp(1024 + fraction, exponent - 25);
  return (half & 0x8000) != 0 ? -size : size;
}

}  // namespace pt
