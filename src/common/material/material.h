// The closed list of materials: a record of 32 bytes and one dispatch.
#pragma once

#include "common/material/dielectric.h"
#include "common/material/diffuse.h"
#include "common/material/metal.h"

namespace pt {

enum class MaterialKind : std::uint32_t { diffuse, metal, dielectric };

struct alignas(16) Material {
  Color albedo = Color(0.5f);
  float parameter = 0.0f;        ///< metal: fuzz; dielectric: eta
  Color emission = Color(0.0f);  ///< radiance on the side to which the normal points
  MaterialKind kind = MaterialKind::diffuse;
};

PT_HD Material make_diffuse(const Color& albedo, const Color& emission = Color(0.0f)) {
  return {albedo, 0.0f, emission, MaterialKind::diffuse};
}
PT_HD Material make_metal(const Color& albedo, float fuzz) {
  return {albedo, fuzz, Color(0.0f), MaterialKind::metal};
}
PT_HD Material make_dielectric(const Color& tint, float eta) {
  return {tint, eta, Color(0.0f), MaterialKind::dielectric};
}

/// Calls `function` with the material's BSDF as a value of its own type.
template <class Function>
PT_HD auto visit(const Material& material, Function&& function) {
  switch (material.kind) {
    case MaterialKind::metal:
      return function(Metal{material.albedo, material.parameter});
    case MaterialKind::dielectric:
      return function(Dielectric{material.albedo, material.parameter});
    default:
      return function(Diffuse{material.albedo});
  }
}

}  // namespace pt
