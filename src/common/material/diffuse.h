// Lambertian reflection, on both sides.
#pragma once

#include "common/material/bsdf.h"
#include "common/sampling/warp.h"

namespace pt {

struct Diffuse {
  Color albedo;

  PT_HD bool is_delta() const { return false; }

  PT_HD BsdfSample sample(const Vec3& wo, const Vec3& n, const Vec4& u) const {
    const Vec3 facing = dot(wo, n) < 0.0f ? -n : n;
    return {sample_cosine_hemisphere(facing, u.x, u.y), albedo};
  }

  PT_HD Color evaluate(const Vec3& wo, const Vec3& wi, const Vec3& n) const {
    return albedo * pdf(wo, wi, n);
  }

  PT_HD float pdf(const Vec3& wo, const Vec3& wi, const Vec3& n) const {
    const float cos_o = dot(wo, n);
    const float cos_i = dot(wi, n);
    return cos_o * cos_i > 0.0f ? multiply_rounded(fabsf(cos_i), inverse_pi) : 0.0f;
  }
};

}  // namespace pt
