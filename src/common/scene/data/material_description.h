// A material as scenes describe it, before prepare_materials() packs it for the kernels. Loaders
// and built-in scenes fill it in, one of them on the device: so it is plain data of fixed size.
#pragma once

#include "common/material/material.h"
#include "common/medium/medium.h"

namespace pt {

inline constexpr int parameters_max = 12;  ///< of one material

struct MaterialDescription {
  MaterialKind kind = kind_of<Diffuse>;
  bool one_sided = false;  ///< black when seen from behind
  Parameter parameters[parameters_max] = {{Color(0.5f)}};
  Emission emission;  ///< on the side to which the normal points
  Opacity opacity;    ///< of the material with its children
  MaterialNode node = MaterialNode::none;
  std::uint32_t children[2] = {};  ///< node: earlier materials of the scene
  bool is_boundary = false;        ///< `media` are on its two sides; else the same on both
  bool passes = false;             ///< boundary without a BSDF: light goes through
  MediumBoundary media;

  /// The parameter that becomes a member of the BSDF: material[&Conductor::eta].
  template <class Bsdf, class Type>
  Parameter& operator[](Type Bsdf::*member) {
    return parameters[index_of(member)];
  }
  template <class Bsdf, class Type>
  const Parameter& operator[](Type Bsdf::*member) const {
    return parameters[index_of(member)];
  }

  // For make_bsdf, without textures.
  PT_HD const Color& color(int i) const { return parameters[i].value; }
  PT_HD float scalar(int i) const { return parameters[i].value.x; }

  bool is_textured() const {
    bool any = emission.texture != no_texture;
    for (const Parameter& p : parameters) any = any || p.texture != no_texture;
    return any;
  }
};

namespace detail {
template <class Bsdf>
bool is_anisotropic(const Parameter* p) {
  if constexpr (requires { &Bsdf::alpha_x; }) {
    const Parameter &x = p[index_of(&Bsdf::alpha_x)], &y = p[index_of(&Bsdf::alpha_y)];
    return x.value != y.value || x.texture != y.texture;
  } else if constexpr (requires { &Bsdf::anisotropic; }) {
    return !is_black(p[index_of(&Bsdf::anisotropic)].value);
  }
  return false;
}
}  // namespace detail

/// Whether the BSDF depends on the direction in which u grows (see bsdf.h).
inline bool uses_tangent(const MaterialDescription& material) {
  return visit(material.kind, material, [&]<class Bsdf>(const Bsdf&) {
    return detail::is_anisotropic<Bsdf>(material.parameters);
  });
}

/// A material with this BSDF and its parameters in their order; the others are 0.
template <class Bsdf, class... Parameters>
PT_HD MaterialDescription make_material(const Parameters&... parameters) {
  static_assert(sizeof...(Parameters) <= parameter_count<Bsdf>);
  MaterialDescription m;
  m.kind = kind_of<Bsdf>;
  int i = 0;
  ((m.parameters[i++].value = Color(parameters)), ...);
  return m;
}

PT_HD MaterialDescription make_diffuse(const Color& albedo, const Color& emission = Color(0.0f)) {
  MaterialDescription m = make_material<Diffuse>(albedo);
  m.emission.radiance = emission;
  return m;
}
PT_HD MaterialDescription make_metal(const Color& albedo, float fuzz) {
  return make_material<Metal>(albedo, fuzz);
}
PT_HD MaterialDescription make_dielectric(const Color& tint, float eta) {
  return make_material<Dielectric>(tint, eta);
}

/// A node over materials with these numbers; `parameter` is its weight or its map.
inline MaterialDescription make_node(MaterialNode node, const Parameter& parameter,
                                     std::uint32_t first, std::uint32_t second) {
  MaterialDescription m;
  m.node = node;
  m.parameters[0] = parameter;
  m.children[0] = first, m.children[1] = second;
  return m;
}
inline MaterialDescription make_two_sided(std::uint32_t front, std::uint32_t back) {
  return make_node(MaterialNode::two_sided, {}, front, back);
}
/// `weight` is that of the second material.
inline MaterialDescription make_blend(const Parameter& weight, std::uint32_t first,
                                      std::uint32_t second) {
  return make_node(MaterialNode::blend, weight, first, second);
}
inline MaterialDescription make_mapped(MaterialNode map, const Parameter& texture,
                                       std::uint32_t inside) {
  return make_node(map, texture, inside, inside);
}

}  // namespace pt
