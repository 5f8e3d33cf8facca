// Phase functions: the list of their types, and its dispatch.
//
// A phase function depends only on the angle between the directions in which a path travels before
// and after scattering; a path that continues straight has cosine 1. Its integral over the sphere
// is 1, so its value is the density of a direction sampled by it, and the weight of such a sample
// is 1. A type has
//   static constexpr const char* name          as scene files call it
//   static T make(float parameter)
//   float value(float cosine) const            per steradian
//   float sample_cosine(float u) const         of that density; u uniform in [0, 1)
#pragma once

#include "common/math/transform.h"
#include "common/platform/type_list.h"
#include "common/sampling/warp.h"

namespace pt {

struct Isotropic {
  static constexpr const char* name = "isotropic";

  PT_HD static Isotropic make(float) { return {}; }
  PT_HD float value(float) const { return unit_sphere_pdf; }
  PT_HD float sample_cosine(float u) const { return fused_multiply_add(2.0f, u, -1.0f); }
};

/// Henyey and Greenstein 1941; pbrt-v4, section 11.3.1. The mean cosine is g, in (-1, 1).
struct HenyeyGreenstein {
  static constexpr const char* name = "hg";
  float g;

  PT_HD static HenyeyGreenstein make(float g) { return {g}; }
  PT_HD float value(float cosine) const {
    const float squared = fmaxf(fused_multiply_add(g, g, 1.0f) - 2.0f * g * cosine, 1e-12f);
    return divide(unit_sphere_pdf * (1.0f - g) * (1.0f + g), squared * fast_sqrt(squared));
  }
  PT_HD float sample_cosine(float u) const {
    if (fabsf(g) < 1e-3f) return fused_multiply_add(2.0f, u, -1.0f);  // what follows cancels
    const float ratio = divide((1.0f - g) * (1.0f + g), fused_multiply_add(2.0f * g, u, 1.0f - g));
    const float cosine =
        divide(fused_multiply_add(-ratio, ratio, fused_multiply_add(g, g, 1.0f)), 2.0f * g);
    return fminf(fmaxf(cosine, -1.0f), 1.0f);
  }
};

/// Scattering by particles smaller than the wavelength. Sampled by Frisvad 2011, 'Importance
/// sampling the Rayleigh phase function', JOSA A 28(12).
struct Rayleigh {
  static constexpr const char* name = "rayleigh";

  PT_HD static Rayleigh make(float) { return {}; }
  PT_HD float value(float cosine) const {
    return 0.75f * unit_sphere_pdf * fused_multiply_add(cosine, cosine, 1.0f);
  }
  PT_HD float sample_cosine(float u) const {
    const float z = fused_multiply_add(4.0f, u, -2.0f);
    // The root of the larger magnitude; the two are each other's negative inverse.
    const float cubed = fabsf(z) + fast_sqrt(fused_multiply_add(z, z, 1.0f));
    const float root = exp2f(log2f(cubed) * (1.0f / 3.0f));
    return copysignf(root - divide(1.0f, root), z);
  }
};

/// Every phase function, once. Its index is its PhaseKind.
using PhaseFunctions = TypeList<Isotropic, HenyeyGreenstein, Rayleigh>;

enum class PhaseKind : std::uint32_t {};
template <class Phase>
inline constexpr PhaseKind phase_kind_of{index_in<Phase>(PhaseFunctions{})};

namespace detail {
template <int index, class Function>
PT_HD auto visit_phase_from(PhaseKind kind, float parameter, Function&& function) {
  using Phase = TypeAt<index, PhaseFunctions>;
  if constexpr (index + 1 < PhaseFunctions::size) {
    if (kind != phase_kind_of<Phase>) {
      return visit_phase_from<index + 1>(kind, parameter, function);
    }
  }
  return function(Phase::make(parameter));
}
}  // namespace detail

/// Calls `function` with the phase function as a value of its own type.
template <class Function>
PT_HD auto visit_phase(PhaseKind kind, float parameter, Function&& function) {
  return detail::visit_phase_from<0>(kind, parameter, function);
}

struct PhaseSample {
  Vec3 wi;    ///< unit vector
  float pdf;  ///< per steradian, and the phase function's value
};

/// A direction for a path that travelled along `direction`.
template <class Phase>
PT_HD PhaseSample sample_phase(const Phase& phase, const Vec3& direction, float u0, float u1) {
  const float cosine = phase.sample_cosine(u0);
  const float sine = fast_sqrt(fmaxf(fused_multiply_add(-cosine, cosine, 1.0f), 0.0f));
  const SinCos phi = sincos_2pi(u1);
  const Vec3 local(sine * phi.cos, sine * phi.sin, cosine);
  return {normalize(make_frame(direction).to_world(local)), phase.value(cosine)};
}

}  // namespace pt
