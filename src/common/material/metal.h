// The paper's metal: a mirror direction, moved by a random point of a ball of radius `fuzz`
// (Shirley, 'Ray Tracing in One Weekend', section 10). Not reciprocal, and directions that fall
// below the surface are absorbed; but it has a density, so light sampling works with it.
#pragma once

#include "common/material/bsdf.h"
#include "common/sampling/warp.h"

namespace pt {

struct Metal {
  static constexpr const char* name = "metal";
  Color albedo;  ///< reflectance, in [0, 1]
  float fuzz;    ///< radius of the ball, in [0, 1]; 0: a perfect mirror

  static constexpr Field<Metal> fields[] = {{"albedo", &Metal::albedo}, {"fuzz", &Metal::fuzz}};
  static constexpr std::uint8_t lobes = Lobe::reflection | Lobe::glossy;

  PT_HD bool is_delta() const { return fuzz == 0.0f; }

  PT_HD BsdfSample sample(const Vec3& wo, const Vec3& u) const {
    const Vec3 mirror = mirrored(wo);
    if (is_delta()) return {mirror, albedo, 0.0f, Lobe::reflection | Lobe::delta};
    const Vec3 sum = add_scaled(mirror, fuzz, sample_unit_ball(u.x, u.y, u.z));
    if (!same_side(sum, wo)) return {};
    const Vec3 wi = normalize(sum);
    return {wi, albedo, ball_pdf(mirror, wi), Lobe::reflection | Lobe::glossy};
  }

  PT_HD BsdfValue evaluate(const Vec3& wo, const Vec3& wi) const {
    if (is_delta() || !same_side(wo, wi)) return {};
    const float pdf = ball_pdf(mirrored(wo), wi);
    return {albedo * pdf, pdf};
  }

 private:
  /// The ball's uniform density, integrated along the ray in direction wi: the integral of t^2 over
  /// the chord [t0, t1], divided by the volume 4/3 pi fuzz^3.
  PT_HD float ball_pdf(const Vec3& mirror, const Vec3& wi) const {
    const float b = dot(mirror, wi);
    const Vec3 off = add_scaled(mirror, -b, wi);
    const float discriminant = fused_multiply_add(fuzz, fuzz, -dot(off, off));
    if (discriminant <= 0.0f) return 0.0f;
    const float half_chord = sqrtf(discriminant);
    const float t0 = fmaxf(b - half_chord, 0.0f);
    const float t1 = fmaxf(b + half_chord, 0.0f);
    return difference_of_products(t1 * t1, t1, t0 * t0, t0) *
           (0.25f * inverse_pi / (fuzz * fuzz * fuzz));
  }
};

}  // namespace pt
