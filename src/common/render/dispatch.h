// From run-time choices to types: calls a generic function with the choice as a constant. Which
// types there are is read from the table of kernels (plan/kernels.h).
#pragma once

#include <array>
#include <type_traits>
#include <utility>

#include "common/plan/kernels.h"
#include "common/platform/type_list.h"
#include "common/sampling/sampler_source.h"
#include "common/scene/data/scene.h"
#include "common/transport/extra_state.h"

namespace pt {

template <class Source>
inline constexpr NumberSource number_source = NumberSource::xorwow;
template <>
inline constexpr NumberSource number_source<PhiloxSource> = NumberSource::philox;
template <>
inline constexpr NumberSource number_source<SamplerSource> = NumberSource::sampler;
template <int records>
inline constexpr NumberSource number_source<CarryingSource<records>> = NumberSource::sampler;

/// The traits of the kernel for such scenes: on a CPU one kernel for all structures and shapes
/// renders what is not the paper's.
constexpr SceneTraits kernel_traits(bool on_cuda, SceneTraits scene) {
  if (!on_cuda && scene.lighting == Lighting::full)
    scene.accel = Accel::any, scene.geometry = Geometry::mixed;
  return scene;
}

/// Whether a kernel of these traits renders one of the scenes for which `has` says so.
template <class Has>
constexpr bool renders_some(bool on_cuda, const SceneTraits& kernel, Has&& has) {
  SceneTraits scene = kernel;
  for (int i = 0; i < static_cast<int>(Accel::any); ++i) {
    scene.accel = Accel{i};
    if (kernel_traits(on_cuda, scene) == kernel && has(scene)) return true;
  }
  return false;
}

/// Kernels with one of these bodies, this source of random numbers and one scene memory.
template <bool on_cuda, class Source, SceneMemory memory, KernelBody... bodies>
struct KernelSelection {
  static constexpr bool has(const SceneTraits& kernel) {
    return renders_some(on_cuda, kernel, [](const SceneTraits& scene) {
      KernelNeed need{on_cuda, {bodies...}, scene, number_source<Source>, memory};
      if constexpr (requires { Source::extra_records; })
        need.extra =
            Source::extra_records == any_extra ? some_records : ExtraRecords{Source::extra_records};
      if (has_kernel(need)) return true;
      need.branching = Branching::reduced;
      return has_kernel(need);
    });
  }
};

/// Whether a CPU has a kernel for such scenes, with any source of random numbers.
constexpr bool has_cpu_kernel(const SceneTraits& scene) {
  using enum NumberSource;
  return has_kernel({false, KernelBody::serial, scene, {philox, xorwow, sampler}});
}

/// Kernels of a CPU's scenes.
struct CpuKernels {
  static constexpr bool has(const SceneTraits& kernel) {
    return renders_some(false, kernel, has_cpu_kernel);
  }
};

/// The traits of the kernel that finds the features of such scenes (film_planes.h): features know
/// no light, and are found once, so few kernels serve all.
constexpr SceneTraits feature_traits(SceneTraits scene) {
  const bool is_mixed = scene.geometry != Geometry::spheres_and_quads;
  if (is_mixed) scene.geometry = Geometry::mixed;
  if (!is_mixed) scene.lighting = Lighting::sky;
  return scene;
}

namespace detail {

inline constexpr int traits_count = accel_count * 3 * 3 * extras_count;

/// All combinations of kernels (Extras), by number.
constexpr SceneTraits traits_at(int i) {
  SceneTraits traits = traits_of(Extras{i / (accel_count * 3 * 3)});
  traits.accel = Accel{i % accel_count}, i /= accel_count;
  traits.geometry = Geometry{i % 3}, i /= 3;
  traits.lighting = Lighting{i % 3};
  return traits;
}

template <class Selection>
consteval int selected_count() {
  int count = 0;
  for (int i = 0; i < traits_count; ++i) count += Selection::has(traits_at(i)) ? 1 : 0;
  return count;
}

/// The index of the n-th combination that the selection has.
template <class Selection>
consteval int selected(int n) {
  for (int i = 0; i < traits_count; ++i)
    if (Selection::has(traits_at(i)) && n-- == 0) return i;
  return -1;
}

template <int i>
using TraitsAt =
    Traits<traits_at(i).accel, traits_at(i).geometry, traits_at(i).lighting, traits_at(i).has_masks,
           traits_at(i).has_media, traits_at(i).has_sparse, traits_at(i).has_motion>;

template <class Selection, int... n>
TypeList<TraitsAt<selected<Selection>(n)>...> traits_of(std::integer_sequence<int, n...>);

}  // namespace detail

/// The list of Traits that a selection of kernels has.
template <class Selection>
using TraitsOf = decltype(detail::traits_of<Selection>(
    std::make_integer_sequence<int, detail::selected_count<Selection>()>{}));

using CpuSceneKinds = TraitsOf<CpuKernels>;

/// Those with this source of random numbers.
template <class Source>
using CpuKindsWith =
    TraitsOf<KernelSelection<false, Source, SceneMemory::global, KernelBody::serial>>;

/// Throws Error, which names them.
[[noreturn]] void throw_no_kernel(const SceneTraits& traits);

/// function(Traits<...>{}) for the member of the list that renders scenes of these traits. Throws
/// Error when none does: the plan was not checked against the table.
template <class Function, class... T>
void dispatch_traits(TypeList<T...>, SceneTraits traits, Function&& function) {
  [[maybe_unused]] const auto called = [&](auto kind) {
    constexpr SceneTraits kernel = decltype(kind)::value();
    const bool is_it = kernel == traits || (kernel.accel == Accel::any && has_cpu_kernel(traits) &&
                                            kernel_traits(false, traits) == kernel);
    if (is_it) function(kind);
    return is_it;
  };
  if (!(called(T{}) || ...)) throw_no_kernel(traits);
}

/// function(Constant<branching>): with Branching::reduced where these kernels exist.
template <bool on_cuda, class Traits, class Source, SceneMemory memory, KernelBody body,
          class Function>
void dispatch_branching(Branching branching, Function&& function) {
  if constexpr (has_kernel({on_cuda, body, Traits::value(), number_source<Source>, memory,
                            Branching::reduced})) {
    if (branching == Branching::reduced) return function(Constant<Branching::reduced>{});
  }
  function(Constant<Branching::divergent>{});
}

}  // namespace pt
