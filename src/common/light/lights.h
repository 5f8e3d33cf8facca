// Every light but the environment: the list of their types, and its dispatch.
//
// A type is the record of its light (see Light), with
//   static constexpr LightKind type       its enumerator
//   static constexpr bool has_position    false: infinitely far, and not in the tree of lights
//   PlainLight sample(const Vec3& from, float u0, float u1)
//                                         on the device, too; triangles have sample_triangle_light
//   LightBounds bounds()                  if it has a position; intensity 0: it emits nothing
// and, for lights without extent,
//   static Type make(const DeltaLight&)   all but the weight
//   Color power(float scene_radius)       W, for choosing among lights; lights infinitely far away
//                                         light a disk of this radius
#pragma once

#include <optional>

#include "common/light/area_light.h"
#include "common/light/distant_lights.h"
#include "common/light/point_lights.h"
#include "common/light/triangle_light.h"
#include "common/platform/type_list.h"

namespace pt {

/// The lights that sample_other_light samples, and all lights. The index is the LightKind.
using OtherLights =
    TypeList<SphereLight, SunLight, PointLight, SpotLight, ProjectorLight, DirectionalLight>;
using Lights =
    decltype(concatenate(TypeList<TriangleLight, FlippedTriangleLight>{}, OtherLights{}));

namespace detail {
template <class... Types>
constexpr bool kinds_are_indices(TypeList<Types...> list) {
  return ((static_cast<int>(Types::type) == index_in<Types>(list)) && ...);
}
static_assert(kinds_are_indices(Lights{}));
}  // namespace detail

/// Calls function(std::type_identity<T>{}) for the light of this kind, which `List` has.
template <class First, class... Rest, class Function>
PT_HD auto visit_light(TypeList<First, Rest...>, LightKind kind, Function&& function) {
  if constexpr (sizeof...(Rest) > 0) {
    if (kind != First::type) return visit_light(TypeList<Rest...>{}, kind, function);
  }
  return function(std::type_identity<First>{});
}

bool has_position(LightKind kind);

/// None for a light without position and for one that emits nothing.
std::optional<LightBounds> bounds_of(const Light& light);

Light make_light(const DeltaLight& delta, float scene_radius);

}  // namespace pt
