// Diffuse surfaces under a highlight: plastics, Phong's and Ward's.
#include <fmt/format.h>

#include "common/scene/data/plastic_material.h"
#include "common/scene/load/mitsuba/surfaces/surface_kinds.h"

namespace pt::mitsuba {
namespace {

/// The second parameter of all of them.
constexpr int specular_parameter = Plastic::Index::specular;
static_assert(specular_parameter == RoughPlastic::Index::specular &&
              specular_parameter == Phong::Index::specular &&
              specular_parameter == Ward::Index::specular);

/// Reads the first two parameters of all of them; they scatter on the side of the normal alone.
Surface glossy_of(Context& context, const Object& bsdf, const MaterialDescription& material,
                  float specular) {
  Surface surface;
  surface.material = material;
  surface.material.one_sided = true;
  surface.material.parameters[color_parameter] =
      parameter_of(read_color_texture(context, bsdf, "diffuse_reflectance", Color(0.5f)));
  surface.material.parameters[specular_parameter] =
      parameter_of(read_color_texture(context, bsdf, "specular_reflectance", Color(specular)));
  return surface;
}

PlasticCoat read_coat(const Object& bsdf) {
  return {relative_ior(bsdf, "polypropylene"), bsdf.boolean("nonlinear", false)};
}

}  // namespace

Surface read_plastic(Context& context, const Object& bsdf) {
  return glossy_of(context, bsdf, make_plastic(Color(0.0f), Color(0.0f), read_coat(bsdf)), 1.0f);
}

Surface read_rough_plastic(Context& context, const Object& bsdf) {
  const Roughness roughness = read_roughness(context, bsdf);
  const ColorTexture& alpha = roughness.alpha_u;
  if (alpha.texture != no_texture) {
    context.warn_once(
        "textured coat", bsdf.element(),
        fmt::format("a texture as alpha of bsdf 'roughplastic' changes its highlight: "
                    "what the coat lets through is that of {}",
                    alpha.color.x));
  }
  Surface surface = glossy_of(context, bsdf,
                              make_rough_plastic(Color(0.0f), Color(0.0f), read_coat(bsdf),
                                                 alpha.color.x, roughness.is_beckmann),
                              1.0f);
  surface.material.parameters[RoughPlastic::Index::alpha].texture = alpha.texture;
  return surface;
}

/// Of Mitsuba 0.x, as `ward`.
Surface read_phong(Context& context, const Object& bsdf) {
  Surface surface = glossy_of(context, bsdf, describe_all<Phong>(), 0.2f);
  surface.material.parameters[Phong::Index::exponent] =
      parameter_of(read_number_texture(context, bsdf, "exponent", 30.0f));
  return surface;
}

Surface read_ward(Context& context, const Object& bsdf) {
  const std::string variant = bsdf.text("variant", "balanced");
  if (variant != "balanced") {
    context.warn_once(
        "ward " + variant, bsdf.element(),
        fmt::format("variant '{}' of bsdf 'ward' is not supported: balanced is used", variant));
  }
  Surface surface = glossy_of(context, bsdf, describe_all<Ward>(), 0.2f);
  const auto alpha = [&](std::string_view axis) {
    const bool own = bsdf.find(axis) || bsdf.child_named(axis);
    return parameter_of(read_number_texture(context, bsdf, own ? axis : "alpha", 0.1f));
  };
  surface.material.parameters[Ward::Index::alpha_x] = alpha("alpha_u");
  surface.material.parameters[Ward::Index::alpha_y] = alpha("alpha_v");
  return surface;
}

}  // namespace pt::mitsuba
