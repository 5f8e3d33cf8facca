// Glass, and blends of surfaces.
#include <fmt/format.h>

#include "common/scene/load/pbrt/surfaces/surface_kinds.h"

namespace pt::pbrt {

Surface read_dielectric(Context& context, const Parameters& parameters) {
  const float eta = read_index(context, parameters, "eta", 1.5f);
  const Roughness roughness = read_roughness(context, parameters);
  Surface surface;
  if (roughness.is_smooth()) {
    surface.material = make_dielectric(Color(1.0f), eta);
  } else {
    surface.material = describe_all<RoughDielectric>(1.0f, 1.0f, eta);
    roughness.store(surface.material.parameters + RoughDielectric::Index::alpha_x);
  }
  return surface;
}

Surface read_thin_dielectric(Context& context, const Parameters& parameters) {
  Surface surface;
  surface.material =
      describe_all<ThinDielectric>(1.0f, 1.0f, read_index(context, parameters, "eta", 1.5f));
  return surface;
}

Surface blend(Context& context, const ColorTexture& weight, const Surface& first,
              const Surface& second) {
  if (weight.is_constant() && weight.color.x <= 0.0f) return first;
  if (weight.is_constant() && weight.color.x >= 1.0f) return second;
  Surface result;
  result.material = make_blend(parameter_of(weight), context.add_material(first.material),
                               context.add_material(second.material));
  return result;
}

/// 'amount' is the share of the second one; that of the first in pbrt-v3, where it may be a colour.
Surface read_mix_material(Context& context, const Parameters& parameters) {
  std::vector<std::string> names = parameters.texts("materials");
  const bool is_earlier = names.empty() && parameters.find("namedmaterial1");
  if (is_earlier) {
    names = {parameters.text("namedmaterial2", ""), parameters.text("namedmaterial1", "")};
  }
  if (names.size() != 2) {
    fail(parameters.place(),
         fmt::format("mix: {} names in 'string materials'; expected 2", names.size()));
  }
  const Parameter* given = parameters.find("amount");
  ColorTexture amount;
  if (is_earlier && given && given->type != "float") {
    amount = read_color_texture(context, parameters, "amount", Color(0.5f));
    if (amount.is_constant()) amount.color = Color(mean(amount.color));
  } else {
    amount = read_number_texture(context, parameters, "amount", 0.5f);
  }
  const Surface first = read_surface(context, names[0], parameters.place());
  const Surface second = read_surface(context, names[1], parameters.place());
  if (first.invisible || second.invisible) {
    fail(parameters.place(), "mix: expected two materials, of which none is 'interface'");
  }
  return blend(context, amount, first, second);
}

}  // namespace pt::pbrt
