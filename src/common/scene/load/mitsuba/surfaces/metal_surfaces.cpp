// Conductors, and the roughness that metals and glass have.
#include <fmt/format.h>

#include <algorithm>

#include "common/material/microfacet.h"
#include "common/scene/load/mitsuba/surfaces/conductors.h"
#include "common/scene/load/mitsuba/surfaces/surface_kinds.h"

namespace pt::mitsuba {
namespace {

/// alpha or alpha_u and alpha_v.
ColorTexture read_alpha(Context& context, const Object& bsdf, std::string_view axis) {
  const bool own = bsdf.find(axis) || bsdf.child_named(axis);
  ColorTexture alpha = read_number_texture(context, bsdf, own ? axis : "alpha", 0.1f);
  // 0 would be a mirror of another kind.
  if (alpha.texture == no_texture) {
    alpha.color = glm::max(alpha.color, Color(Microfacets::alpha_min));
  }
  return alpha;
}

bool read_is_beckmann(Context& context, const Object& bsdf) {
  std::string name = bsdf.text("distribution", "beckmann");
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
  if (name == "beckmann" || name == "ggx") return name == "beckmann";
  if (context.modern) {
    fail(*bsdf.find("distribution"),
         fmt::format("distribution '{}'; expected beckmann or ggx", name));
  }
  context.warn_once("distribution " + name, bsdf.element(),
                    fmt::format("distribution '{}' is not supported: beckmann is used", name));
  return true;
}

}  // namespace

const ConductorIndex& read_named_metal(Context& context, const Object& bsdf) {
  const auto find = [](std::string_view name) {
    return std::ranges::find(conductors, name, &ConductorIndex::name);
  };
  const std::string name = bsdf.text("material", context.modern ? "none" : "Cu");
  if (const auto metal = find(name); metal != conductors.end()) return *metal;
  context.warn_once("metal " + name, bsdf.element(),
                    fmt::format("the conductor '{}' is not known: aluminium is used", name));
  return *find("Al");
}

namespace {

/// eta and k, or those of a metal by name, over the index of what is outside.
void read_index(Context& context, const Object& bsdf, Parameter* eta_and_k) {
  const bool given =
      bsdf.find("eta") || bsdf.child_named("eta") || bsdf.find("k") || bsdf.child_named("k");
  ColorTexture eta, k;
  if (given) {
    eta = read_color_texture(context, bsdf, "eta", Color(0.0f), Quantity::index_of_refraction);
    k = read_color_texture(context, bsdf, "k", Color(1.0f), Quantity::index_of_refraction);
  } else {
    const ConductorIndex& metal = read_named_metal(context, bsdf);
    eta.color = metal.eta, k.color = metal.k;
  }
  const float outside = outside_ior(bsdf);
  eta.color /= outside, k.color /= outside;
  eta_and_k[0] = parameter_of(eta);
  eta_and_k[1] = parameter_of(k);
}

Surface conductor_of(Context& context, const Object& bsdf) {
  Surface surface;
  surface.material = describe_all<Conductor>(0);
  surface.material.parameters[Conductor::Index::tint] =
      parameter_of(read_color_texture(context, bsdf, "specular_reflectance", Color(1.0f)));
  read_index(context, bsdf, surface.material.parameters + Conductor::Index::eta);
  surface.material.one_sided = true;
  return surface;
}

}  // namespace

void Roughness::store(Parameter* parameters) const {
  parameters[0] = parameter_of(alpha_u);
  parameters[1] = parameter_of(alpha_v);
  parameters[2].value = Color(is_beckmann ? 1.0f : 0.0f);
}

Roughness read_roughness(Context& context, const Object& bsdf) {
  bsdf.ignore({"sample_visible"});
  return {read_alpha(context, bsdf, "alpha_u"), read_alpha(context, bsdf, "alpha_v"),
          read_is_beckmann(context, bsdf)};
}

Surface read_conductor(Context& context, const Object& bsdf) { return conductor_of(context, bsdf); }

Surface read_rough_conductor(Context& context, const Object& bsdf) {
  Surface surface = conductor_of(context, bsdf);
  read_roughness(context, bsdf).store(surface.material.parameters + Conductor::Index::alpha_x);
  return surface;
}

}  // namespace pt::mitsuba
