// Materials to the nearest of ours.
#pragma once

#include "common/scene/load/pbrt/surfaces/textures.h"

namespace pt::pbrt {

/// What a material becomes.
struct Surface {
  MaterialDescription material;
  bool invisible = false;      ///< light passes as if nothing were there
  bool keeps_opacity = false;  ///< its material's opacity holds where a shape has no 'alpha'
  std::vector<TextureMapping> mappings = {};  ///< of its textures
};

/// An Error about a name that is not defined has `place`. Each replacement is reported once for its
/// kind. Adding a material is adding a line to the table in surfaces.cpp.
Surface read_surface(Context& context, const MaterialReference& reference,
                     const FileLocation& place);

// The kinds of materials: each reads one.

using Reader = Surface (*)(Context&, const Parameters&);

Surface read_diffuse(Context& context, const Parameters& parameters);
Surface read_coated_diffuse(Context& context, const Parameters& parameters);
Surface read_diffuse_transmission(Context& context, const Parameters& parameters);
Surface read_conductor(Context& context, const Parameters& parameters);
Surface read_coated_conductor(Context& context, const Parameters& parameters);
Surface read_dielectric(Context& context, const Parameters& parameters);
Surface read_thin_dielectric(Context& context, const Parameters& parameters);
Surface read_subsurface(Context& context, const Parameters& parameters);
Surface read_hair(Context& context, const Parameters& parameters);
Surface read_measured(Context& context, const Parameters& parameters);
Surface read_mix_material(Context& context, const Parameters& parameters);
Surface read_interface(Context& context, const Parameters& parameters);

// Those of pbrt-v3.
Surface read_matte(Context& context, const Parameters& parameters);
Surface read_plastic(Context& context, const Parameters& parameters);
Surface read_metal(Context& context, const Parameters& parameters);
Surface read_mirror(Context& context, const Parameters& parameters);
Surface read_glass(Context& context, const Parameters& parameters);
Surface read_uber(Context& context, const Parameters& parameters);
Surface read_substrate(Context& context, const Parameters& parameters);
Surface read_translucent(Context& context, const Parameters& parameters);
Surface read_disney(Context& context, const Parameters& parameters);
Surface read_subsurface_of_color(Context& context, const Parameters& parameters);

/// What is between two surfaces, of which the second has this share; opacities and what is
/// invisible are kept where that is possible.
Surface blend(Context& context, const ColorTexture& weight, const Surface& first,
              const Surface& second);

/// The facets' alpha along u and v, as the three last parameters of Conductor and
/// RoughDielectric: GGX.
struct Roughness {
  ColorTexture alpha_u, alpha_v;

  /// Below this pbrt's surfaces are smooth.
  static constexpr float smooth = 1e-3f;
  bool is_smooth() const {
    return alpha_u.is_constant() && alpha_v.is_constant() &&
           std::max(alpha_u.color.x, alpha_v.color.x) < smooth;
  }
  void store(pt::Parameter* parameters) const;
};

/// Reads `prefix` + roughness, uroughness and vroughness, remapped as in pbrt-v3 where that is
/// asked for.
Roughness read_roughness(Context& context, const Parameters& parameters,
                         const std::string& prefix = {}, float fallback = 0.0f,
                         bool is_earlier = false);

/// A surface that reflects `reflected` and lets `passed` through, both diffusely.
Surface diffuse_both_ways(Context& context, const ColorTexture& reflected,
                          const ColorTexture& passed);

/// A boundary over a diffuse body (see read_coated_diffuse).
Surface coated(const ColorTexture& body, float eta, const Roughness& roughness);

/// A metal of eta and k, over the index of what is outside.
Surface conductor_of(const ColorTexture& eta, const ColorTexture& k, const Roughness& roughness);

/// The thickness of a coat.
float read_thickness(Context& context, const Parameters& parameters);

/// Reports, once for the material's kind, that it is replaced `by` something.
void report_replaced(Context& context, const Parameters& parameters, std::string_view by);

}  // namespace pt::pbrt
