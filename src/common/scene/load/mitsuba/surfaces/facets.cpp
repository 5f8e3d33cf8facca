// Glass, metals, plastics: indices of refraction, roughness, highlights.
#include <algorithm>
#include <map>

#include "common/material/microfacet.h"
#include "common/scene/data/plastic_material.h"
#include "common/scene/load/files/text.h"
#include "common/scene/load/mitsuba/surfaces/surfaces.h"
#include "common/scene/load/mitsuba/xml/elements.h"

namespace pt::mitsuba {
namespace {

/// Names and values as in Mitsuba's documentation of `dielectric`.
const std::map<std::string_view, double>& dielectrics() {
  static const std::map<std::string_view, double> table = {
      {"vacuum", 1.0},      {"helium", 1.000036},        {"hydrogen", 1.000132},
      {"air", 1.000277},    {"carbon dioxide", 1.00045}, {"water", 1.3330},
      {"acetone", 1.36},    {"ethanol", 1.361},          {"carbon tetrachloride", 1.461},
      {"glycerol", 1.4729}, {"benzene", 1.501},          {"silicone oil", 1.52045},
      {"bromine", 1.661},   {"water ice", 1.31},         {"fused quartz", 1.458},
      {"pyrex", 1.470},     {"acrylic glass", 1.49},     {"polypropylene", 1.49},
      {"bk7", 1.5046},      {"sodium chloride", 1.544},  {"amber", 1.55},
      {"pet", 1.5750},      {"diamond", 2.419}};
  return table;
}

double ior_of(const Object& bsdf, std::string_view name, double fallback) {
  const Element* at = bsdf.find(name);
  if (!at) return fallback;
  const std::string& text = at->required("value");
  const auto known = dielectrics().find(lower_case(text));
  if (known != dielectrics().end()) return known->second;
  const std::optional<double> number = parse_number(text);
  if (!number || !(*number > 0)) {
    fail(*at, "{} is '{}'; expected a number above 0 or a name such as bk7 or air", name, text);
  }
  return *number;
}

}  // namespace

float relative_ior(const Object& bsdf, std::string_view inside) {
  return static_cast<float>(ior_of(bsdf, "int_ior", dielectrics().at(inside)) /
                            ior_of(bsdf, "ext_ior", dielectrics().at("air")));
}

float outside_ior(const Object& bsdf) { return static_cast<float>(ior_of(bsdf, "ext_eta", 1.0)); }

namespace {

// Glass: solid, rough and thin.

ColorTexture tint(Context& context, const Object& bsdf, std::string_view name) {
  return read_color_texture(context, bsdf, name, Color(1.0f));
}

bool is_plain(const ColorTexture& a, const ColorTexture& b) {
  return a.texture == no_texture && b.texture == no_texture && a.color == b.color;
}

}  // namespace

/// Smooth glass of one tint, which most is, has a BSDF of its own.
Surface read_dielectric(Context& context, const Object& bsdf) {
  const ColorTexture reflected = tint(context, bsdf, "specular_reflectance");
  const ColorTexture passed = tint(context, bsdf, "specular_transmittance");
  const float eta = relative_ior(bsdf);
  Surface surface;
  if (is_plain(reflected, passed)) {
    surface.material = make_dielectric(passed.color, eta);
  } else {
    surface.material = make_material<RoughDielectric>(0, 0, eta, 0, 0, 0);
    surface.material[&RoughDielectric::reflected] = parameter_of(reflected);
    surface.material[&RoughDielectric::passed] = parameter_of(passed);
  }
  return surface;
}

Surface read_rough_dielectric(Context& context, const Object& bsdf) {
  const Roughness roughness = read_roughness(context, bsdf);
  Surface surface;
  surface.material = make_material<RoughDielectric>(0, 0, relative_ior(bsdf));
  MaterialDescription& m = surface.material;
  m[&RoughDielectric::reflected] = parameter_of(tint(context, bsdf, "specular_reflectance"));
  m[&RoughDielectric::passed] = parameter_of(tint(context, bsdf, "specular_transmittance"));
  roughness.store(&m[&RoughDielectric::alpha_x]);
  return surface;
}

Surface read_thin_dielectric(Context& context, const Object& bsdf) {
  Surface surface;
  surface.material = make_material<ThinDielectric>(0, 0, relative_ior(bsdf));
  surface.material[&ThinDielectric::reflected] =
      parameter_of(tint(context, bsdf, "specular_reflectance"));
  surface.material[&ThinDielectric::passed] =
      parameter_of(tint(context, bsdf, "specular_transmittance"));
  return surface;
}

namespace {

// Conductors, and the roughness that metals and glass have.

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
  const std::string name = lower_case(bsdf.text("distribution", "beckmann"));
  if (name == "beckmann" || name == "ggx") return name == "beckmann";
  if (context.modern) {
    fail(*bsdf.find("distribution"), "distribution '{}'; expected beckmann or ggx", name);
  }
  context.warn_once("distribution " + name, bsdf.element(),
                    "distribution '{}' is not supported: beckmann is used", name);
  return true;
}

}  // namespace

const std::vector<ConductorIndex> conductors = {
#include <tables/conductors.inc>
};

namespace {

/// By the property `material`; one that is not known becomes aluminium with a warning.
const ConductorIndex& read_named_metal(Context& context, const Object& bsdf) {
  const auto find = [](std::string_view name) {
    return std::ranges::find(conductors, name, &ConductorIndex::name);
  };
  const std::string name = bsdf.text("material", context.modern ? "none" : "Cu");
  if (const auto metal = find(name); metal != conductors.end()) return *metal;
  context.warn_once("metal " + name, bsdf.element(),
                    "the conductor '{}' is not known: aluminium is used", name);
  return *find("Al");
}

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
  surface.material = make_material<Conductor>(0);
  surface.material[&Conductor::tint] =
      parameter_of(read_color_texture(context, bsdf, "specular_reflectance", Color(1.0f)));
  read_index(context, bsdf, &surface.material[&Conductor::eta]);
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
  read_roughness(context, bsdf).store(&surface.material[&Conductor::alpha_x]);
  return surface;
}

namespace {

// Diffuse surfaces under a highlight: plastics, Phong's and Ward's.

/// The second parameter of all of them.
constexpr int specular_parameter = index_of(&Plastic::specular);
static_assert(specular_parameter == index_of(&RoughPlastic::specular) &&
              specular_parameter == index_of(&Phong::specular) &&
              specular_parameter == index_of(&Ward::specular));

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
    context.warn_once("textured coat", bsdf.element(),
                      "a texture as alpha of bsdf 'roughplastic' changes its highlight: what the "
                      "coat lets through is that of {}",
                      alpha.color.x);
  }
  Surface surface = glossy_of(context, bsdf,
                              make_rough_plastic(Color(0.0f), Color(0.0f), read_coat(bsdf),
                                                 alpha.color.x, roughness.is_beckmann),
                              1.0f);
  surface.material[&RoughPlastic::alpha].texture = alpha.texture;
  return surface;
}

/// Only in Mitsuba 0.x, as `ward`.
Surface read_phong(Context& context, const Object& bsdf) {
  Surface surface = glossy_of(context, bsdf, make_material<Phong>(), 0.2f);
  surface.material[&Phong::exponent] =
      parameter_of(read_number_texture(context, bsdf, "exponent", 30.0f));
  return surface;
}

Surface read_ward(Context& context, const Object& bsdf) {
  const std::string variant = bsdf.text("variant", "balanced");
  if (variant != "balanced") {
    context.warn_once("ward " + variant, bsdf.element(),
                      "variant '{}' of bsdf 'ward' is not supported: balanced is used", variant);
  }
  Surface surface = glossy_of(context, bsdf, make_material<Ward>(), 0.2f);
  const auto alpha = [&](std::string_view axis) {
    const bool own = bsdf.find(axis) || bsdf.child_named(axis);
    return parameter_of(read_number_texture(context, bsdf, own ? axis : "alpha", 0.1f));
  };
  surface.material[&Ward::alpha_x] = alpha("alpha_u");
  surface.material[&Ward::alpha_y] = alpha("alpha_v");
  return surface;
}

}  // namespace pt::mitsuba
