// The paper's metal: a mirror direction, moved by a random point of a ball of radius `fuzz`
// (Shirley, 'Ray Tracing in One Weekend', section 10). Not reciprocal, and directions that fall
// below the surface are absorbed; but it has a density, so light sampling works with it.
#pragma once

#include "common/material/bsdf.h"
#include "common/sampling/warp.h"

namespace pt {

struct Metal {
  Color albedo;
  float fuzz;  ///< in [0, 1]; 0: a perfect mirror

  PT_HD bool is_delta() const { return fuzz == 0.0f; }

  PT_HD BsdfSample sample(const Vec3& wo, const Vec3& n, const Vec4& u) const {
    const float cos_o = dot(wo, n);
    const Vec3 mirror = reflect(wo, n);
    if (is_delta()) return {normalize(mirror), albedo};
    const Vec3 sum = mirror + fuzz * sample_unit_ball(u.x, u.y, u.z);
    if (dot(sum, n) * cos_o <= 0.0f) return {};
    return {normalize(sum), albedo};
  }

  PT_HD Color evaluate(const Vec3& wo, const Vec3& wi, const Vec3& n) const {
    return albedo * pdf(wo, wi, n);
  }

  PT_HD float pdf(const Vec3& wo, const Vec3& wi, const Vec3& n) const {
    if (is_delta() || dot(wo, n) * dot(wi, n) <= 0.0f) return 0.0f;
    return ball_pdf(reflect(wo, n), wi);
  }

 private:
  /// The ball's uniform density, integrated along the ray in direction wi: the integral of t^2 over
  /// the chord [t0, t1], divided by the volume 4/3 pi fuzz^3.
  PT_HD float ball_pdf(const Vec3& mirror, const Vec3& wi) const {
    const float b = dot(mirror, wi);
    const Vec3 off = mirror - b * wi;
    const float discriminant = fuzz * fuzz - dot(off, off);
    if (discriminant <= 0.0f) return 0.0f;
    const float half_chord = sqrtf(discriminant);
    const float t0 = fmaxf(b - half_chord, 0.0f);
    const float t1 = fmaxf(b + half_chord, 0.0f);
    return multiply_rounded(difference_of_products(t1 * t1, t1, t0 * t0, t0),
                            0.25f * inverse_pi / (fuzz * fuzz * fuzz));
  }
};

}  // namespace pt
