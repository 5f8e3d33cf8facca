// The contract of a BSDF. Directions point away from the surface; `n` is the outward unit normal.
//
// A BSDF is a small value with three functions:
//   BsdfSample sample(wo, n, u)    chooses wi; u uniform in [0, 1)^4
//   Color evaluate(wo, wi, n)      f(wo, wi) |cos wi|; black for a delta BSDF
//   float pdf(wo, wi, n)           density of sample() per solid angle; 0 for a delta BSDF
// and `bool is_delta()`: true when it scatters into discrete directions only. A scene without
// lights never asks for a density, so sample() does not compute one. Adding one: a file here, its
// name in material.h's list. tests/material/test_bsdf.cpp then tests it.
#pragma once

#include "common/math/vec.h"

namespace pt {

struct BsdfSample {
  Vec3 wi = Vec3(0.0f);
  Color weight = Color(0.0f);  ///< f |cos| / pdf; black: the path is absorbed
  float outside = 1.0f;        ///< weight times this is what Russian roulette goes by
};

PT_HD Vec3 reflect(const Vec3& wo, const Vec3& n) { return 2.0f * dot(wo, n) * n - wo; }

}  // namespace pt
