// From run-time choices to types: calls a generic function with the choice as a constant.
#pragma once

#include <type_traits>
#include <utility>

#include "common/render/options.h"
#include "common/sampling/random.h"
#include "common/scene/scene.h"
#include "common/transport/path_integrator.h"
#include "common/type_list.h"

namespace pt {

/// Every integrator, in the order of IntegratorKind.
using Integrators = TypeList<PathIntegrator>;

// The kinds of scenes for which kernels exist. The paper's scenes have lean ones of their own;
// whatever a file can hold shares the rest.
using BruteSphereKinds =
    TypeList<Traits<Accel::brute, Geometry::spheres_and_quads, Lighting::sky>,
             Traits<Accel::brute, Geometry::spheres_and_quads, Lighting::emitters>>;
using SphereSceneKinds = decltype(concatenate(
    BruteSphereKinds{},
    TypeList<Traits<Accel::bvh2, Geometry::spheres_and_quads, Lighting::sky>,
             Traits<Accel::bvh2, Geometry::spheres_and_quads, Lighting::emitters>>{}));
using TriangleSceneKinds = TypeList<Traits<Accel::bvh2, Geometry::triangles, Lighting::full>,
                                    Traits<Accel::cwbvh, Geometry::triangles, Lighting::full>,
                                    Traits<Accel::brute, Geometry::mixed, Lighting::full>,
                                    Traits<Accel::bvh2, Geometry::mixed, Lighting::full>,
                                    Traits<Accel::cwbvh, Geometry::mixed, Lighting::full>,
                                    Traits<Accel::bvh2, Geometry::mixed, Lighting::full, true>,
                                    Traits<Accel::cwbvh, Geometry::mixed, Lighting::full, true>>;
using SceneKinds = decltype(concatenate(SphereSceneKinds{}, TriangleSceneKinds{}));
using CpuSceneKinds = decltype(concatenate(
    SceneKinds{}, TypeList<Traits<Accel::embree, Geometry::mixed, Lighting::full>,
                           Traits<Accel::brute, Geometry::mixed, Lighting::full, true>>{}));

/// Random numbers with a stored state are the paper's, and kept for its scenes.
template <class Source>
inline constexpr bool draws_in_all_scenes = std::is_same_v<Source, PhiloxSource>;
/// Of the list `All`, the kinds of scenes that have kernels with this source.
template <class Source, class All>
using KindsWith = std::conditional_t<draws_in_all_scenes<Source>, All, SphereSceneKinds>;

/// Throws Error, which names them.
[[noreturn]] void throw_no_kernel(const SceneTraits& traits, IntegratorKind integrator);

/// function(Traits<...>{}) for the member of the list that has these traits and this integrator.
/// Throws Error when none has.
template <class Function, class... T>
void dispatch_traits(TypeList<T...>, SceneTraits traits, IntegratorKind integrator,
                     Function&& function) {
  const auto called = [&](auto kind) {
    using Kind = decltype(kind);
    const bool is_it =
        Kind::value() == traits &&
        IntegratorKind{index_in<typename Kind::Integrator>(Integrators{})} == integrator;
    if (is_it) function(kind);
    return is_it;
  };
  if (!(called(T{}) || ...)) throw_no_kernel(traits, integrator);
}

/// function(Constant<branching>). Branches are reduced in the paper's scenes only.
template <class Traits, class Function>
void dispatch_branching(Branching branching, Function&& function) {
  if constexpr (Traits::geometry == Geometry::spheres_and_quads) {
    if (branching == Branching::reduced) return function(Constant<Branching::reduced>{});
  }
  function(Constant<Branching::divergent>{});
}

}  // namespace pt
