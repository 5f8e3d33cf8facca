// The inverse of the error function.
#pragma once

#include "common/platform/platform.h"

namespace pt {

/// x with erff(x) = y, |y| < 1; relative error 3e-7 (the single-precision polynomials of Giles
/// 2010, 'Approximating the erfinv function'). +-1 gives about +-3.8.
PT_HD float erf_inverse(float y) {
  float w = -logf(fmaxf((1.0f - y) * (1.0f + y), 1e-7f));
  float p;
  if (w < 5.0f) {
    w = w - 2.5f;
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
  return multiply_rounded(p, y);
}

}  // namespace pt
