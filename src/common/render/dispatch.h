// From run-time choices to types: calls a generic function with the choice as a constant.
#pragma once

#include <type_traits>
#include <utility>

#include "common/options/options.h"
#include "common/platform/type_list.h"
#include "common/sampling/sampler_source.h"
#include "common/scene/data/scene.h"
#include "common/transport/path_integrator.h"

namespace pt {

/// Every integrator, in the order of IntegratorKind.
using Integrators = TypeList<PathIntegrator>;

/// Whose kernels trace the paths: Metropolis light transport is a way to draw their numbers.
constexpr IntegratorKind traced_by(IntegratorKind integrator) {
  return integrator == IntegratorKind::mlt ? IntegratorKind::path : integrator;
}

// The kinds of scenes for which kernels exist. The paper's scenes have lean ones of their own;
// whatever a file can hold shares the rest.
using BruteSkyKinds = TypeList<Traits<Accel::brute, Geometry::spheres_and_quads, Lighting::sky>>;
using BruteSphereKinds = decltype(concatenate(
    BruteSkyKinds{},
    TypeList<Traits<Accel::brute, Geometry::spheres_and_quads, Lighting::emitters>>{}));
using SphereSceneKinds = decltype(concatenate(
    BruteSphereKinds{},
    TypeList<Traits<Accel::bvh2, Geometry::spheres_and_quads, Lighting::sky>,
             Traits<Accel::bvh2, Geometry::spheres_and_quads, Lighting::emitters>>{}));
template <Geometry geometry, bool has_masks, class... TreeAccel>
TypeList<Traits<TreeAccel::value, geometry, Lighting::full, has_masks>...> kinds_with_trees(
    TypeList<TreeAccel...>);
template <Geometry geometry, bool has_masks = false>
using KindsWithTrees = decltype(kinds_with_trees<geometry, has_masks>(TreeAccels{}));
/// Of scenes with media, which may have all else as well.
template <Accel accel>
using MediaKind = Traits<accel, Geometry::mixed, Lighting::full, true, true>;
using TriangleSceneKinds = decltype(concatenate(
    KindsWithTrees<Geometry::triangles>{},
    concatenate(KindsWithTrees<Geometry::mixed>{}, KindsWithTrees<Geometry::mixed, true>{})));
using MediaSceneKinds = TypeList<MediaKind<Accel::bvh2>, MediaKind<Accel::cwbvh>>;
/// Those that a megakernel's loop traces on CUDA.
using LoopTriangleKinds =
    decltype(concatenate(KindsWithTrees<Geometry::triangles>{},
                         TypeList<Traits<Accel::bvh2, Geometry::mixed, Lighting::full>,
                                  Traits<Accel::bvh2, Geometry::mixed, Lighting::full, true>,
                                  MediaKind<Accel::bvh2>>{}));
using CpuTriangleSceneKinds = decltype(concatenate(
    TriangleSceneKinds{},
    TypeList<Traits<Accel::cwbvh_avx2, Geometry::triangles, Lighting::full>,
             Traits<Accel::brute, Geometry::mixed, Lighting::full>,
             Traits<Accel::cwbvh_avx2, Geometry::mixed, Lighting::full>,
             Traits<Accel::embree, Geometry::mixed, Lighting::full>,
             Traits<Accel::brute, Geometry::mixed, Lighting::full, true>, MediaKind<Accel::bvh2>,
             MediaKind<Accel::cwbvh>, MediaKind<Accel::brute>>{}));
using CpuSceneKinds = decltype(concatenate(SphereSceneKinds{}, CpuTriangleSceneKinds{}));

/// The kinds of scenes that have kernels with this source: samplers are for all but the paper's
/// scenes, which keep its generators.
template <class Source, class OtherKinds>
using KindsWith =
    std::conditional_t<std::is_same_v<Source, SamplerSource>, OtherKinds, SphereSceneKinds>;

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
        IntegratorKind{index_in<typename Kind::Integrator>(Integrators{})} == traced_by(integrator);
    if (is_it) function(kind);
    return is_it;
  };
  if (!(called(T{}) || ...)) throw_no_kernel(traits, integrator);
}

/// The same on CUDA, where each of the paper's toggles has kernels alone, and only for its scene:
/// spheres that are scanned, under the sky (check_toggles).
template <class Source, class OtherKinds>
using CudaKindsWith = std::conditional_t<std::is_same_v<Source, PhiloxSource> ||
                                             std::is_same_v<Source, SamplerSource>,
                                         KindsWith<Source, OtherKinds>, BruteSkyKinds>;

/// Of scenes whose spheres lie in such memory.
template <SceneMemory memory>
using KindsInMemory =
    std::conditional_t<memory == SceneMemory::shared, BruteSkyKinds, BruteSphereKinds>;

/// Whether CUDA has kernels of reduced branching for such scenes, by this source and memory.
template <class Traits, class Source, SceneMemory memory = SceneMemory::global>
inline constexpr bool may_reduce_on_cuda =
    Traits::accel == Accel::brute&& Traits::lighting ==
    Lighting::sky&& std::is_same_v<Source, PhiloxSource>&& memory == SceneMemory::global;

/// function(Constant<branching>). Branches are reduced in the paper's scenes only.
template <class Traits, bool may_reduce = true, class Function>
void dispatch_branching(Branching branching, Function&& function) {
  if constexpr (may_reduce && Traits::geometry == Geometry::spheres_and_quads) {
    if (branching == Branching::reduced) return function(Constant<Branching::reduced>{});
  }
  function(Constant<Branching::divergent>{});
}

}  // namespace pt
