// Materials: the closed list of BSDFs, a record that names one, and its dispatch.
#pragma once

#include "common/material/compensated_conductor.h"
#include "common/material/conductor.h"
#include "common/material/dielectric.h"
#include "common/material/diffuse.h"
#include "common/material/metal.h"
#include "common/material/oren_nayar.h"
#include "common/material/phong.h"
#include "common/material/plastic.h"
#include "common/material/principled.h"
#include "common/material/principled_thin.h"
#include "common/material/rough_dielectric.h"
#include "common/material/rough_plastic.h"
#include "common/material/thin_dielectric.h"
#include "common/material/ward.h"
#include "common/platform/type_list.h"
#include "common/texture/texture.h"

namespace pt {

/// Every BSDF, once. Its index is its MaterialKind.
using Bsdfs =
    TypeList<Diffuse, Metal, Dielectric, OrenNayar, Plastic, RoughPlastic, Phong, Ward, Conductor,
             RoughDielectric, ThinDielectric, Principled, PrincipledThin, CompensatedConductor>;

/// The first ones, those of the paper's scenes: no others are in kernels without triangles.
using PaperBsdfs = TypeList<Diffuse, Metal, Dielectric>;

enum class MaterialKind : std::uint8_t {};
template <class Bsdf>
inline constexpr MaterialKind kind_of{static_cast<std::uint8_t>(index_in<Bsdf>(Bsdfs{}))};

/// Of a material made of others, whose BSDFs are not all of one kind.
inline constexpr MaterialKind several_kinds{Bsdfs::size};
/// Whoever has something for each kind has so many.
inline constexpr int kind_count = Bsdfs::size + 1;

/// A colour, or a number in all of its components, times a texture where there is one.
struct alignas(16) Parameter {
  Color value = Color(0.0f);
  std::uint32_t texture = no_texture;
};

/// The first parameter of all BSDFs: their colour (albedo, tint, base colour).
inline constexpr int color_parameter = 0;

/// Nothing emits.
inline constexpr std::uint32_t no_emission = 0xffffffffu;

/// What a material does that is no BSDF itself but is made of other materials: see
/// resolve_material. Its first parameter is what it needs.
enum class MaterialNode : std::uint8_t {
  none,        ///< it is a BSDF
  two_sided,   ///< one material on the side of the normal, another on the other side
  blend,       ///< of the first material and, by a weight, of the second
  normal_map,  ///< a texture turns the normal: 2 x - 1 along tangent, their cross product, normal
  gltf_normal_map,  ///< likewise; the second axis goes where v grows, and it has a scale
  bump_map          ///< a texture of heights, times a scale, turns the normal
};

/// 16 bytes: one load. Its first parameter, which nearly all BSDFs have, has the material's own
/// number in the scene's pool, so that it can be read beside this record; the others follow behind
/// those of all materials.
struct alignas(16) Material {
  static constexpr std::uint8_t one_sided = 1;  ///< black when seen from behind
  static constexpr std::uint8_t delta = 2;      ///< Bsdf::is_delta(): no light sampling
  static constexpr std::uint8_t textured = 4;   ///< some parameter, or the emission
  static constexpr std::uint8_t tangents = 8;   ///< needs a tangent along which u grows
  static constexpr std::uint8_t nested = 16;    ///< no BSDF, but a MaterialNode
  static constexpr std::uint8_t boundary = 32;  ///< the media on its two sides are known
  static constexpr std::uint8_t passes = 64;    ///< a boundary without a BSDF: light goes through

  MaterialKind kind = kind_of<Diffuse>;  ///< nested: of all that it may become, or several_kinds
  std::uint8_t flags = 0;
  MaterialNode node = MaterialNode::none;
  std::uint32_t parameters = 0;          ///< where the others begin in the pool; nested: `first`
  std::uint32_t emission = no_emission;  ///< which of the scene's Emissions
  std::uint32_t second = 0;              ///< nested: a material

  PT_HD std::uint32_t first() const { return parameters; }  ///< nested: a material

  PT_HD bool is(std::uint8_t flag) const { return (flags & flag) != 0; }
};

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

/// Whether all that a BSDF scatters stays on the side from which it came.
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
  return function(Bsdf::make(parameters));
}
}  // namespace detail

/// Calls `function` with the BSDF as a value of its own type, made of parameters (see bsdf.h).
/// `List` is Bsdfs or a list with which it begins, if `kind` is one of it.
template <class List = Bsdfs, class Parameters, class Function>
PT_HD_IN_KERNEL auto visit(MaterialKind kind, const Parameters& parameters, Function&& function) {
  return detail::visit_from<List, 0>(kind, parameters, function);
}

}  // namespace pt
