// Lambertian reflection, on both sides (pbrt-v4, section 9.2).
#pragma once

#include "common/material/bsdf.h"
#include "common/sampling/warp.h"

namespace pt {

struct Diffuse {
  static constexpr const char* name = "diffuse";
  /// Indices of the material's parameters.
  struct Index {
    enum : int {
      albedo,  ///< reflectance, in [0, 1]
      count
    };
  };
  static constexpr int parameter_count = Index::count;
  static constexpr std::uint8_t lobes = Lobe::reflection | Lobe::diffuse;

  Color albedo;  ///< f = albedo / pi

  template <class Parameters>
  PT_HD static Diffuse make(const Parameters& p) {
    return {p.color(Index::albedo)};
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
