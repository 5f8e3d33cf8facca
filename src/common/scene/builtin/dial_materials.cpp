#include "common/scene/builtin/dial_materials.h"

#include "common/math/sincos.h"
#include "common/scene/data/plastic_material.h"

namespace pt {
namespace {

/// What differs from one round of the kinds to the next.
struct Look {
  Color hue;              ///< about 1
  float roughness;        ///< of facets, in [0, 1]
  float exponent, index;  ///< of Phong's highlight; of plastics and glass
  int is_beckmann;
};

Look look_of(std::uint32_t material_index, std::uint32_t round) {
  constexpr float roughness[] = {0.15f, 0.3f, 0.1f}, exponent[] = {20, 60, 8};
  constexpr float index[] = {1.5f, 1.4f, 1.6f};
  Look look{Color(1.0f), roughness[round % 3], exponent[round % 3], index[round % 3],
            static_cast<int>(round % 2)};
  for (int c = 0; c < 3; ++c) {  // turns by the golden ratio: neighbours differ most
    const float turns =
        0.618034f * static_cast<float>(material_index) + static_cast<float>(c) / 3.0f;
    look.hue[c] += 0.12f * sincos_2pi(turns - std::floor(turns)).cos;
  }
  return look;
}

using Maker = MaterialDescription (*)(const Look&);

/// The dial's own list: a new BSDF does not join it, for the scene is a benchmark. The numbers make
/// the albedos alike.
constexpr Maker makers[] = {
    [](const Look& l) { return make_diffuse(0.75f * l.hue); },
    [](const Look& l) {
      return make_material<Conductor>(0.79f * l.hue, 0.0f, 1.0f, l.roughness, l.roughness,
                                      l.is_beckmann);
    },
    [](const Look& l) { return make_plastic(0.73f * l.hue, Color(1.0f), {l.index}); },
    [](const Look& l) {
      return make_rough_plastic(0.85f * l.hue, Color(1.0f), {l.index}, l.roughness,
                                l.is_beckmann != 0);
    },
    // Roughness, metallic, transmission, index, anisotropic, specular tint, sheen and its tint,
    // flatness, coat and its gloss.
    [](const Look& l) {
      return make_material<Principled>(0.69f * l.hue, std::sqrt(l.roughness), 0.0f, 0.0f, l.index,
                                       0.0f, 0.2f, 0.2f, 0.5f, 0.2f, 0.3f, 0.5f);
    },
    [](const Look& l) { return make_material<Phong>(0.5f * l.hue, Color(0.37f), l.exponent); },
    [](const Look& l) {
      return make_material<Ward>(0.45f * l.hue, Color(0.33f), l.roughness, l.roughness);
    },
    [](const Look& l) { return make_material<OrenNayar>(0.78f * l.hue, l.roughness); },
    [](const Look& l) { return make_metal(0.76f * l.hue, l.roughness); },
    // Roughness, transmission, index, anisotropic, specular tint, sheen and its tint, flatness.
    [](const Look& l) {
      return make_material<PrincipledThin>(0.75f * l.hue, std::sqrt(l.roughness), 0.0f, l.index,
                                           0.0f, 0.2f, 0.1f, 0.5f, 0.2f, 0.0f);
    },
    [](const Look& l) { return make_material<ThinDielectric>(Color(1.0f), Color(1.0f), l.index); },
    [](const Look& l) { return make_dielectric(Color(1.0f), l.index - 0.3f); },
    [](const Look& l) {
      return make_material<RoughDielectric>(Color(1.0f), Color(1.0f), l.index - 0.3f, l.roughness,
                                            l.roughness, l.is_beckmann);
    },
};
static_assert(std::size(makers) == dial_kinds);

}  // namespace

MaterialDescription make_dial_material(std::uint32_t index) {
  return makers[index % dial_kinds](look_of(index, index / dial_kinds));
}

}  // namespace pt
