// The contract of a BSDF. It works in the local shading frame: z is the normal, x the tangent;
// directions have unit length and point away from the surface.
//
// A BSDF is a small value:
//   static constexpr const char* name      what it is called in messages and statistics
//   struct Index                           the indices of its material's parameters, with ranges
//   static constexpr int parameter_count   Index::count, at most parameters_max
//   static Bsdf make(const Parameters& p)  from p.color(i) and p.scalar(i), textures included
//   static constexpr std::uint8_t lobes    of Lobe: all that sample() may return, but where it
//                                          is_delta(), which sides alone
//   static bool uses_tangent(const Parameter* p)   where there is one: whether x must be the
//                                          direction in which the surface's u grows; else any
//   bool is_delta()                        whether it scatters into discrete directions only
//   BsdfSample sample(wo, u)               chooses wi; u uniform in [0, 1)^3
//   BsdfValue evaluate(wo, wi)             f(wo, wi) |cos wi| and the density of sample() at once
//
// Adding one: a file here, its name in material.h's list, and a line in
// tests/support/material/bsdf_cases.h with parameters for the tests, which iterate the list.
#pragma once

#include "common/math/vec.h"

namespace pt {

/// What a sampled direction belongs to: a side and a kind.
struct Lobe {
  static constexpr std::uint8_t reflection = 1, transmission = 2;
  static constexpr std::uint8_t diffuse = 4, glossy = 8, delta = 16;
};

struct BsdfSample {
  Vec3 wi = Vec3(0.0f);        ///< local; need not have unit length but for rounding
  Color weight = Color(0.0f);  ///< f |cos| / pdf; black: the path is absorbed
  float pdf = 0.0f;            ///< per solid angle; meaningless for a delta lobe
  std::uint8_t lobe = 0;       ///< of Lobe, one side and one kind
  float eta = 1.0f;            ///< index of refraction beyond over before; 1 for reflection
  float eta_scale = 1.0f;      ///< undoes the 1 / eta^2 of radiance inside, for Russian roulette

  PT_HD bool is_delta() const { return (lobe & Lobe::delta) != 0; }
};

struct BsdfValue {
  Color f = Color(0.0f);  ///< f |cos wi|; black for a delta BSDF
  float pdf = 0.0f;       ///< per solid angle; 0 for a delta BSDF
};

PT_HD bool same_side(const Vec3& wo, const Vec3& wi) { return wo.z * wi.z > 0.0f; }

/// Of `wo` about the normal.
PT_HD Vec3 mirrored(const Vec3& wo) { return {-wo.x, -wo.y, wo.z}; }

}  // namespace pt
