// Every light but the environment: the closed list of their types, and its dispatch.
//
// A type has
//   static constexpr LightKind kind   its enumerator
//   static constexpr bool has_place   false: infinitely far; the tree of lights has none of these
//   static PlainLight sample(const Light&, const Vec3& from, float u0, float u1)
//                                     on the device, too; but for triangles
//   static LightBounds bounds(const Light&)   where it has a place; no intensity: nothing shines
// and one without extent, which a DeltaLight describes,
//   static Color power(const DeltaLight&, float scene_radius)
//                                     W of all of it, for choosing among lights; of what is
//                                     infinitely far over a disk of this radius
//   static void store(const DeltaLight&, Light&)   optional: what add to what make_light has stored
#pragma once

#include <optional>

#include "common/light/directional_light.h"
#include "common/light/point_light.h"
#include "common/light/projector_light.h"
#include "common/light/sphere_light.h"
#include "common/light/spot_light.h"
#include "common/light/sun_light.h"
#include "common/light/triangle_light.h"
#include "common/platform/type_list.h"

namespace pt {

/// Those that one function samples, and all. The place is the LightKind.
using OtherLights =
    TypeList<SphereLight, SunLight, PointLight, SpotLight, ProjectorLight, DirectionalLight>;
using Lights =
    decltype(concatenate(TypeList<TriangleLight, MirroredTriangleLight>{}, OtherLights{}));

namespace detail {
template <class... Types>
constexpr bool kinds_are_places(TypeList<Types...> list) {
  return ((static_cast<int>(Types::kind) == index_in<Types>(list)) && ...);
}
static_assert(kinds_are_places(Lights{}));
}  // namespace detail

/// Calls function(std::type_identity<T>{}) for the light of this kind, which `List` has.
template <class First, class... Rest, class Function>
PT_HD auto visit_light(TypeList<First, Rest...>, LightKind kind, Function&& function) {
  if constexpr (sizeof...(Rest) > 0) {
    if (kind != First::kind) return visit_light(TypeList<Rest...>{}, kind, function);
  }
  return function(std::type_identity<First>{});
}

bool has_position(LightKind kind);

/// None for a light without place and for one that gives nothing.
std::optional<LightBounds> bounds_of(const Light& light);

/// Of lights without extent.
Color delta_light_power(const DeltaLight& light, float scene_radius);
Light make_light(const DeltaLight& delta, float scene_radius);

}  // namespace pt
