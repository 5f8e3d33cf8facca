// The contract of a BSDF. It works in the local shading frame: z is the normal, x the tangent;
// directions have unit length and point away from the surface.
//
// A BSDF is a small value whose members are the parameters of its material:
//   static constexpr const char* name      what it is called in messages and statistics
//   static constexpr Field<Bsdf> fields[]  its parameters: the only list of them. make_bsdf, the
//                                          scene's pool of parameters, the loaders, scene.params
//                                          and the tests follow it
//   template <int i> void limit()          optional: brings parameters into their ranges when
//                                          parameter i has been read
//   static constexpr std::uint8_t lobes    of Lobe: all that sample() may return; where is_delta()
//                                          holds, only the sides count
//   bool is_delta()                        whether it scatters into discrete directions only
//   BsdfSample sample(wo, u)               chooses wi; u uniform in [0, 1)^3
//   BsdfValue evaluate(wo, wi)             f(wo, wi) |cos wi| and the density of sample() at once
// The tangent is the direction in which the surface's u grows where `alpha_x` and `alpha_y` differ
// or `anisotropic` is not 0, in BSDFs with such members. Elsewhere it is any direction.
//
// Adding one: a file here, its name in material.h's list, and a line in
// tests/support/material/bsdf_cases.h with parameters for the tests, which iterate the list.
#pragma once

#include <cstdlib>
#include <iterator>

#include "common/math/vec.h"

namespace pt {

/// The side and the type of a sampled direction.
struct Lobe {
  static constexpr std::uint8_t reflection = 1, transmission = 2;
  static constexpr std::uint8_t diffuse = 4, glossy = 8, delta = 16;
};

struct BsdfSample {
  Vec3 wi = Vec3(0.0f);        ///< local; unit length but for rounding
  Color weight = Color(0.0f);  ///< f |cos| / pdf; black: the path is absorbed
  float pdf = 0.0f;            ///< per solid angle; meaningless for a delta lobe
  std::uint8_t lobe = 0;       ///< of Lobe, one side and one type
  float eta = 1.0f;            ///< index of refraction beyond over before; 1 for reflection
  float eta_scale = 1.0f;      ///< undoes the 1 / eta^2 of radiance inside, for Russian roulette

  PT_HD bool is_delta() const { return (lobe & Lobe::delta) != 0; }
};

struct BsdfValue {
  Color f = Color(0.0f);  ///< f |cos wi|; black for a delta BSDF
  float pdf = 0.0f;       ///< per solid angle; 0 for a delta BSDF
};

PT_HD bool same_side(const Vec3& wo, const Vec3& wi) { return wo.z * wi.z > 0.0f; }

/// `wo` mirrored at the normal.
PT_HD Vec3 mirrored(const Vec3& wo) { return {-wo.x, -wo.y, wo.z}; }

/// The sample of a direction of unit length that `value` evaluates.
PT_HD BsdfSample sample_of(const Vec3& wi, const BsdfValue& value, bool is_glossy) {
  if (!(value.pdf > 0.0f)) return {};
  const int kind = is_glossy ? Lobe::glossy : Lobe::diffuse;
  return {wi, value.f * divide(1.0f, value.pdf), value.pdf,
          static_cast<std::uint8_t>(Lobe::reflection | kind)};
}

struct BsdfParameter {
  const char* name = "";
  bool is_color = false;        ///< else a number
  bool is_precomputed = false;  ///< computed from the others, not chosen by a user
};

inline constexpr bool precomputed = true;

/// A parameter and the member that it becomes: a colour, a number, or a flag (a number other than
/// 0). Its place in Bsdf::fields is the parameter's index in a material.
template <class Bsdf>
struct Field : BsdfParameter {
  using ColorMember = Color Bsdf::*;
  using NumberMember = float Bsdf::*;
  using FlagMember = bool Bsdf::*;

  ColorMember color = nullptr;
  NumberMember number = nullptr;
  FlagMember flag = nullptr;

  constexpr Field(const char* n, ColorMember member, bool is_made = false)
      : BsdfParameter{n, true, is_made}, color(member) {}
  constexpr Field(const char* n, NumberMember member) : BsdfParameter{n}, number(member) {}
  constexpr Field(const char* n, FlagMember member) : BsdfParameter{n}, flag(member) {}

  constexpr bool is(ColorMember member) const { return color == member; }
  constexpr bool is(NumberMember member) const { return number == member; }
  constexpr bool is(FlagMember member) const { return flag == member; }
};

template <class Bsdf>
inline constexpr int parameter_count = static_cast<int>(std::size(Bsdf::fields));

/// The index of the parameter that becomes this member: index_of(&Conductor::eta).
template <class Bsdf, class Type>
constexpr int index_of(Type Bsdf::*member) {
  for (int i = 0; i < parameter_count<Bsdf>; ++i) {
    if (Bsdf::fields[i].is(member)) return i;
  }
  std::abort();  // the member is not in `fields`; as a constant expression: does not compile
}

namespace detail {
template <int i, class Bsdf, class Parameters>
PT_HD_IN_KERNEL void read_fields(Bsdf& bsdf, const Parameters& p) {
  if constexpr (i < parameter_count<Bsdf>) {
    constexpr auto field = Bsdf::fields[i];
    if constexpr (field.color != nullptr) {
      bsdf.*field.color = p.color(i);
    } else if constexpr (field.number != nullptr) {
      bsdf.*field.number = p.scalar(i);
    } else {
      bsdf.*field.flag = p.scalar(i) != 0.0f;
    }
    if constexpr (requires { bsdf.template limit<i>(); }) bsdf.template limit<i>();
    read_fields<i + 1>(bsdf, p);
  }
}
}  // namespace detail

/// The BSDF of a material. `parameters` have color(i) and scalar(i), textures included.
template <class Bsdf, class Parameters>
PT_HD_IN_KERNEL Bsdf make_bsdf(const Parameters& parameters) {
  Bsdf bsdf{};
  detail::read_fields<0>(bsdf, parameters);
  return bsdf;
}

}  // namespace pt
