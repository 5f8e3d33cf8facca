// Lambertian reflection, on both sides.
#pragma once

#include "common/material/bsdf.h"
#include "common/sampling/warp.h"

namespace pt {

struct Diffuse {
  static constexpr const char* name = "diffuse";
  static constexpr int parameter_count = 1;
  static constexpr std::uint8_t lobes = Lobe::reflection | Lobe::diffuse;

  Color albedo;

  template <class Parameters>
  PT_HD static Diffuse make(const Parameters& p) {
    return {p.color(0)};
  }

  PT_HD bool is_delta() const { return false; }

  PT_HD BsdfSample sample(const Vec3& wo, const Vec3& u) const {
    Vec3 wi = sample_cosine_hemisphere(u.x, u.y);
    const float pdf = cosine_hemisphere_pdf(wi.z);
    if (wo.z < 0.0f) wi.z = -wi.z;
    return {wi, albedo, pdf, Lobe::reflection | Lobe::diffuse};
  }

  PT_HD BsdfValue evaluate(const Vec3& wo, const Vec3& wi) const {
    if (!same_side(wo, wi)) return {};
    const float pdf = cosine_hemisphere_pdf(fabsf(wi.z));
    return {albedo * pdf, pdf};
  }
};

}  // namespace pt
