// Materials of pbrt-v3, by its formulas: most are sums of lobes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "common/scene/load/pbrt/surfaces/surfaces.h"
#include "common/scene/load/pbrt/syntax/parameters.h"

namespace pt::pbrt {
namespace {

bool is_nothing(const ColorTexture& value) { return value.is_constant() && is_black(value.color); }

float size_of(const ColorTexture& value) { return std::max(mean(value.color), 0.0f); }

/// A sum of surfaces: a blend of them, each over its share.
class LobeSum {
 public:
  explicit LobeSum(Context& context) : context_(context) {}

  /// `make` is given what to multiply the lobe by; `weight` is about how much light it reflects.
  template <class Make>
  void add(float weight, const Make& make) {
    lobes_.push_back({std::max(weight, 1e-3f), make});
  }

  Surface surface() const {
    if (lobes_.empty()) return diffuse(Color(0.0f));
    float all = 0.0f, before = 0.0f;
    for (const Lobe& lobe : lobes_) all += lobe.weight;
    Surface result;
    for (const Lobe& lobe : lobes_) {
      const Surface own = lobe.make(all / lobe.weight);
      const float share = lobe.weight / (before + lobe.weight);
      result = before == 0.0f ? own : blend(context_, {Color(share)}, result, own);
      before += lobe.weight;
    }
    return result;
  }

  static Surface diffuse(const Color& albedo) {
    Surface surface;
    surface.material = make_diffuse(albedo);
    return surface;
  }

 private:
  struct Lobe {
    float weight;
    std::function<Surface(float)> make;
  };
  Context& context_;
  std::vector<Lobe> lobes_;
};

Surface diffuse_of(const ColorTexture& albedo) {
  Surface surface;
  surface.material[&Diffuse::albedo] = parameter_of(albedo);
  return surface;
}

/// Facets of a dielectric whose reflections and transmissions are multiplied by colours.
Surface facets_of(const ColorTexture& reflected, const ColorTexture& passed, float eta,
                  const Roughness& roughness) {
  Surface surface;
  surface.material = make_material<RoughDielectric>(1.0f, 1.0f, eta);
  surface.material[&RoughDielectric::reflected] = parameter_of(reflected);
  surface.material[&RoughDielectric::passed] = parameter_of(passed);
  roughness.store(&surface.material[&RoughDielectric::alpha_x]);
  return surface;
}

Roughness earlier_roughness(Context& context, const Parameters& parameters, float fallback) {
  return read_roughness(context, parameters, {}, fallback, true);
}

const Roughness smooth_facets{{Color(0.0f)}, {Color(0.0f)}};

/// 'eta', or 'index' as it was called before.
float read_earlier_index(Context& context, const Parameters& parameters) {
  const char* name = parameters.find("eta") ? "eta" : "index";
  const float eta = read_plain_number(context, parameters, name, 1.5f);
  if (eta > 0.0f) return eta;
  fail(parameters.place(), "{}: an '{}' of {}; expected one above 0", parameters.what(), name, eta);
}

void add_diffuse(LobeSum& sum, const ColorTexture& kd) {
  if (is_nothing(kd)) return;
  sum.add(size_of(kd), [kd](float by) { return diffuse_of(scaled(kd, by)); });
}

/// Fresnel's share of ks from facets. What such a lobe lets pass is black.
void add_highlight(LobeSum& sum, const ColorTexture& ks, float eta, const Roughness& roughness) {
  if (is_nothing(ks)) return;
  sum.add(0.2f * size_of(ks),
          [=](float by) { return facets_of(scaled(ks, by), {Color(0.0f)}, eta, roughness); });
}

}  // namespace

/// Its `sigma` (Oren and Nayar's) is left out, as `pbrt --upgrade` does.
Surface read_matte(Context& context, const Parameters& parameters) {
  if (read_plain_number(context, parameters, "sigma", 0.0f) > 0.0f) {
    context.reporter.warn_once("sigma", parameters.place(),
                               "'sigma' of material 'matte' is not supported and ignored");
  }
  return diffuse_of(read_color_texture(context, parameters, "Kd", Color(0.5f)));
}

/// pbrt-v3 takes the highlight's index from inside to outside, which makes it a mirror towards the
/// horizon; here it is 1.5 from outside.
Surface read_plastic(Context& context, const Parameters& parameters) {
  LobeSum sum(context);
  add_diffuse(sum, read_color_texture(context, parameters, "Kd", Color(0.25f)));
  add_highlight(sum, read_color_texture(context, parameters, "Ks", Color(0.25f)), 1.5f,
                earlier_roughness(context, parameters, 0.1f));
  return sum.surface();
}

Surface read_metal(Context& context, const Parameters& parameters) {
  parameters.ignore({"Kr"});
  const auto read = [&](const char* name, const char* copper) {
    return read_color_texture(context, parameters, name, *named_metal(copper), Quantity::unbounded);
  };
  return conductor_of(read("eta", "metal-Cu-eta"), read("k", "metal-Cu-k"),
                      earlier_roughness(context, parameters, 0.01f));
}

Surface read_mirror(Context& context, const Parameters& parameters) {
  Surface surface = conductor_of({Color(0.0f)}, {Color(1.0f)}, smooth_facets);
  surface.material[&Conductor::tint] =
      parameter_of(read_color_texture(context, parameters, "Kr", Color(0.9f)));
  return surface;
}

Surface read_glass(Context& context, const Parameters& parameters) {
  const ColorTexture kr = read_color_texture(context, parameters, "Kr", Color(1.0f));
  const ColorTexture kt = read_color_texture(context, parameters, "Kt", Color(1.0f));
  const float eta = read_earlier_index(context, parameters);
  const auto is_zero = [&](const char* name) {
    const ColorTexture value = read_number_texture(context, parameters, name, 0.0f);
    return value.is_constant() && value.color.x == 0.0f;
  };
  const bool is_smooth = is_zero("uroughness") && is_zero("vroughness");
  const Roughness roughness = earlier_roughness(context, parameters, 0.0f);
  if (!is_smooth) return facets_of(kr, kt, eta, roughness);
  const bool is_clear = kr.is_constant() && kt.is_constant() && kr.color == kt.color;
  if (!is_clear) return facets_of(kr, kt, eta, smooth_facets);
  Surface surface;
  surface.material = make_dielectric(kr.color, eta);
  return surface;
}

/// Where it is not opaque, light passes straight on.
Surface read_uber(Context& context, const Parameters& parameters) {
  const float eta = read_earlier_index(context, parameters);
  const ColorTexture kr = read_color_texture(context, parameters, "Kr", Color(0.0f));
  const ColorTexture kt = read_color_texture(context, parameters, "Kt", Color(0.0f));
  LobeSum sum(context);
  add_diffuse(sum, read_color_texture(context, parameters, "Kd", Color(0.25f)));
  add_highlight(sum, read_color_texture(context, parameters, "Ks", Color(0.25f)), eta,
                earlier_roughness(context, parameters, 0.1f));
  if (!is_nothing(kr) || !is_nothing(kt)) {
    sum.add(0.2f * size_of(kr) + size_of(kt), [=](float by) {
      return facets_of(scaled(kr, by), scaled(kt, by), eta, smooth_facets);
    });
  }
  Surface surface = sum.surface();
  const ColorTexture opacity = read_color_texture(context, parameters, "opacity", Color(1.0f));
  if (opacity.is_constant() && opacity.color == Color(1.0f)) return surface;
  surface.material.opacity = opacity.is_constant()
                                 ? constant_opacity(mean(opacity.color))
                                 : textured_opacity(mean(opacity.color), opacity.texture);
  surface.keeps_opacity = true;
  surface.invisible = opacity.is_constant() && is_black(opacity.color);
  return surface;
}

/// Ashikhmin and Shirley's. Its diffuse part is Kd (1 - Ks) times 0.97 along the normal, 0.89 at 45
/// and 0.76 at 60 degrees; ours has one factor. Its highlight is that of facets which reflect Ks
/// along the normal.
Surface read_substrate(Context& context, const Parameters& parameters) {
  constexpr float seen = 0.95f;
  const ColorTexture kd = read_color_texture(context, parameters, "Kd", Color(0.5f));
  const ColorTexture ks = read_color_texture(context, parameters, "Ks", Color(0.5f));
  const Roughness roughness = earlier_roughness(context, parameters, 0.1f);
  const float along_normal = std::clamp(mean(ks.color), 0.0f, 0.95f);
  LobeSum sum(context);
  add_diffuse(sum, scaled(kd, seen * (Color(1.0f) - glm::min(ks.color, Color(1.0f)))));
  if (along_normal > 0.0f) {
    add_highlight(sum, scaled(ks, 1.0f / along_normal), index_of_reflectance(along_normal),
                  roughness);
  }
  return sum.surface();
}

Surface read_translucent(Context& context, const Parameters& parameters) {
  const auto read = [&](const char* name, float fallback) {
    return read_color_texture(context, parameters, name, Color(fallback));
  };
  const ColorTexture kd = read("Kd", 0.25f), ks = read("Ks", 0.25f);
  const auto plain = [&](const char* name) {
    const ColorTexture value = read(name, 0.5f);
    if (value.is_constant()) return value.color;
    context.reporter.warn_once(fmt::format("textured {}", name), parameters.find(name)->place,
                               "a texture as '{}' is not supported: 0.5 is used", name);
    return Color(0.5f);
  };
  const Color reflect = plain("reflect"), transmit = plain("transmit");
  const Roughness roughness = earlier_roughness(context, parameters, 0.1f);
  LobeSum sum(context);
  if (!is_nothing(kd)) {
    sum.add(size_of(kd), [&](float by) {
      return diffuse_both_ways(context, scaled(kd, by * reflect), scaled(kd, by * transmit));
    });
  }
  if (!is_nothing(ks)) {
    sum.add(size_of(ks), [&](float by) {
      return facets_of(scaled(ks, by * reflect), scaled(ks, by * transmit), 1.5f, roughness);
    });
  }
  return sum.surface();
}

/// Burley's, as Mitsuba has it; what scatters below the surface does so at it.
Surface read_disney(Context& context, const Parameters& parameters) {
  const auto number = [&](const char* name, float fallback = 0.0f) {
    return parameter_of(read_number_texture(context, parameters, name, fallback));
  };
  Surface surface;
  const pt::Parameter color =
      parameter_of(read_color_texture(context, parameters, "color", Color(0.5f)));
  const float eta = read_plain_number(context, parameters, "eta", 1.5f);
  parameters.ignore({"scatterdistance", "difftrans", "metallic", "clearcoat", "clearcoatgloss"});
  const auto make_common = [&]<class Bsdf>(std::type_identity<Bsdf>) {
    MaterialDescription m = make_material<Bsdf>(0);
    m[&Bsdf::base_color] = color;
    m[&Bsdf::eta].value = Color(std::max(eta, 1.001f));
    m[&Bsdf::roughness] = number("roughness", 0.5f);
    m[&Bsdf::spec_trans] = number("spectrans");
    m[&Bsdf::anisotropic] = number("anisotropic");
    m[&Bsdf::spec_tint] = number("speculartint");
    m[&Bsdf::sheen] = number("sheen");
    m[&Bsdf::sheen_tint] = number("sheentint", 0.5f);
    m[&Bsdf::flatness] = number("flatness");
    return m;
  };
  if (parameters.boolean("thin", false)) {
    surface.material = make_common(std::type_identity<PrincipledThin>{});
    surface.material[&PrincipledThin::diff_trans] = number("difftrans", 1.0f);
    return surface;
  }
  MaterialDescription& m = surface.material = make_common(std::type_identity<Principled>{});
  m[&Principled::metallic] = number("metallic");
  m[&Principled::clearcoat] = number("clearcoat");
  m[&Principled::clearcoat_gloss] = number("clearcoatgloss", 1.0f);
  const pt::Parameter& passes = m[&Principled::spec_trans];
  m.one_sided = passes.texture == no_texture && is_black(passes.value);
  return surface;
}

/// kdsubsurface: what leaves it is Kd.
Surface read_subsurface_of_color(Context& context, const Parameters& parameters) {
  report_replaced(context, parameters, "a coated diffuse surface of its 'Kd' is used");
  const ColorTexture kd = read_color_texture(context, parameters, "Kd", Color(0.5f));
  const float eta = read_plain_number(context, parameters, "eta", 1.33f);
  const Roughness roughness = earlier_roughness(context, parameters, 0.0f);
  parameters.ignore_all();
  if (!(eta > 0.0f)) fail(parameters.place(), "kdsubsurface: expected an 'eta' above 0");
  return coated(kd, eta, roughness);
}

}  // namespace pt::pbrt
