// The closed list of materials: a plain record and one dispatch.
#pragma once

#include "common/material/dielectric.h"
#include "common/material/diffuse.h"
#include "common/material/metal.h"
#include "common/texture/texture.h"

namespace pt {

enum class MaterialKind : std::uint8_t { diffuse, metal, dielectric };

/// 32 bytes: two loads.
struct alignas(16) Material {
  Color albedo = Color(0.5f);
  float parameter = 0.0f;        ///< metal: fuzz; dielectric: eta
  Color emission = Color(0.0f);  ///< radiance on the side to which the normal points
  MaterialKind kind = MaterialKind::diffuse;
  bool one_sided = false;      ///< black when seen from behind; a diffuse surface only
  std::uint16_t textures = 0;  ///< which of the scene's MaterialTextures; 0: none
};

/// Numbers of textures that multiply a material's colours, or no_texture.
struct MaterialTextures {
  std::uint32_t albedo = no_texture;
  std::uint32_t emission = no_texture;
  float emission_mean = 1.0f;  ///< luminance of the texture of emission, set by prepare_scene()
};

PT_HD Material make_diffuse(const Color& albedo, const Color& emission = Color(0.0f)) {
  return {albedo, 0.0f, emission};
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
