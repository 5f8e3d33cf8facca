// Materials: the list of BSDFs, the records of a material (BSDF, emission, opacity), and dispatch.
#pragma once

#include "common/material/conductor.h"
#include "common/material/dielectric.h"
#include "common/material/diffuse.h"
#include "common/material/highlights.h"
#include "common/material/metal.h"
#include "common/material/plastic.h"
#include "common/material/principled.h"
#include "common/material/principled_thin.h"
#include "common/material/rough_dielectric.h"
#include "common/platform/type_list.h"
#include "common/texture/texture.h"

namespace pt {

/// Every BSDF, once. Its index is its MaterialKind.
using Bsdfs =
    TypeList<Diffuse, Metal, Dielectric, OrenNayar, Plastic, RoughPlastic, Phong, Ward, Conductor,
             RoughDielectric, ThinDielectric, Principled, PrincipledThin, CompensatedConductor>;

/// The BSDFs of the paper's scenes, which Bsdfs begins with. Kernels without triangles have no
/// others.
using PaperBsdfs = TypeList<Diffuse, Metal, Dielectric>;

enum class MaterialKind : std::uint8_t {};
template <class Bsdf>
inline constexpr MaterialKind kind_of{static_cast<std::uint8_t>(index_in<Bsdf>(Bsdfs{}))};

/// A material made of others whose BSDFs differ in type.
inline constexpr MaterialKind several_kinds{Bsdfs::size};
/// All kinds, with several_kinds.
inline constexpr int kind_count = Bsdfs::size + 1;

/// A colour, or a number in all of its components, times a texture where there is one.
struct alignas(16) Parameter {
  Color value = Color(0.0f);
  std::uint32_t texture = no_texture;
};

/// The first parameter of all BSDFs: their colour (albedo, tint, base colour).
inline constexpr int color_parameter = 0;

inline constexpr std::uint32_t no_emission = 0xffffffffu;

/// How a material combines other materials (resolve_material). Its first parameter is the weight or
/// the map.
enum class MaterialNode : std::uint8_t {
  none,        ///< no combination: a BSDF
  two_sided,   ///< one material on the side of the normal, another on the other side
  blend,       ///< the second material with the probability `weight`, else the first
  normal_map,  ///< a texture turns the normal: 2 x - 1 along tangent, their cross product, normal
  gltf_normal_map,  ///< likewise, with a scale; the second axis points to where v grows
  bump_map          ///< a texture of heights, times a scale, turns the normal
};

/// 16 bytes: one load. The pool of parameters begins with the first parameter of each material, by
/// the material's index, so that it can be read together with this record. The other parameters
/// follow, material after material.
struct alignas(16) Material {
  static constexpr std::uint8_t one_sided = 1;  ///< black when seen from behind
  static constexpr std::uint8_t delta = 2;      ///< Bsdf::is_delta(): no light sampling
  static constexpr std::uint8_t textured = 4;   ///< a parameter or the emission has a texture
  static constexpr std::uint8_t tangents = 8;   ///< needs a tangent along which u grows
  static constexpr std::uint8_t nested = 16;    ///< a MaterialNode, not a BSDF
  static constexpr std::uint8_t boundary = 32;  ///< a boundary between two media
  static constexpr std::uint8_t passes = 64;    ///< a boundary without a BSDF: light goes through

  MaterialKind kind = kind_of<Diffuse>;  ///< nested: that of all leaves, or several_kinds
  std::uint8_t flags = 0;
  MaterialNode node = MaterialNode::none;
  std::uint32_t parameters = 0;          ///< index of the second one in the pool; nested: first()
  std::uint32_t emission = no_emission;  ///< index among the scene's Emissions
  std::uint32_t second = 0;              ///< nested: a material

  PT_HD std::uint32_t first() const { return parameters; }  ///< nested: a material

  PT_HD bool is(std::uint8_t flag) const { return (flags & flag) != 0; }
};

/// The emission of a surface. 32 bytes: two loads.
struct alignas(16) Emission {
  Color radiance = Color(0.0f);        ///< W / (m^2 sr), on the side to which the normal points
  std::uint32_t texture = no_texture;  ///< multiplies it
  float texture_mean = 1.0f;           ///< the texture's mean luminance, for light selection
};

/// Stochastic opacity of a surface: a ray that the mask lets through continues as if the surface
/// was not there. 16 bytes: one load. The opacity, offset + scale * the texture's luminance, at
/// most 1, is the probability that a ray hits the surface; with a cutoff the ray hits it where the
/// opacity is at least the cutoff.
struct alignas(16) Opacity {
  float offset = 1.0f;
  float scale = 0.0f;
  std::uint32_t texture = no_texture;
  float cutoff = 0.0f;  ///< 0: none; light_hidden: none, and the surface is invisible to the camera

  static constexpr float light_hidden = -1.0f;

  PT_HD bool is_opaque() const { return texture == no_texture && offset >= 1.0f; }
  PT_HD bool hides_from_camera() const { return cutoff < 0.0f; }
  PT_HD bool is_constant() const { return texture == no_texture; }
};

inline Opacity constant_opacity(float value) { return {value, 0.0f, no_texture, 0.0f}; }
inline Opacity textured_opacity(float scale, std::uint32_t texture, float cutoff = 0.0f) {
  return texture == no_texture ? Opacity{scale, 0.0f, no_texture, cutoff}
                               : Opacity{0.0f, scale, texture, cutoff};
}

namespace detail {
template <class... Types>
constexpr std::uint64_t reflective_kinds(TypeList<Types...>) {
  std::uint64_t kinds = 0;
  ((kinds |= std::uint64_t{(Types::lobes & Lobe::transmission) == 0}
             << static_cast<int>(kind_of<Types>)),
   ...);
  return kinds;
}
}  // namespace detail

/// Whether the BSDF scatters light only to the side from which it came.
PT_HD bool reflects_only(MaterialKind kind) {
  constexpr std::uint64_t kinds = detail::reflective_kinds(Bsdfs{});
  static_assert(Bsdfs::size <= 64);
  return (kinds >> static_cast<int>(kind) & 1u) != 0;
}

namespace detail {
template <class List, int index, class Parameters, class Function>
PT_HD_IN_KERNEL auto visit_from(MaterialKind kind, const Parameters& parameters,
                                Function&& function) {
  using Bsdf = TypeAt<index, List>;
  if constexpr (index + 1 < List::size) {
    if (kind != kind_of<Bsdf>) return visit_from<List, index + 1>(kind, parameters, function);
  }
  return function(make_bsdf<Bsdf>(parameters));
}
}  // namespace detail

/// Calls `function` with the BSDF as a value of its own type, made of parameters (see make_bsdf).
/// `List` is Bsdfs or PaperBsdfs and has `kind`.
template <class List = Bsdfs, class Parameters, class Function>
PT_HD_IN_KERNEL auto visit(MaterialKind kind, const Parameters& parameters, Function&& function) {
  return detail::visit_from<List, 0>(kind, parameters, function);
}

}  // namespace pt
