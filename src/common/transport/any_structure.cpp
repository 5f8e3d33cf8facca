// What a CPU's kernels for any structure share: tracing in the one that the scene names, and
// shading.
#include <array>
#include <utility>

#include "common/transport/shade_surface.h"

namespace pt {
namespace {

/// A scene's rays in one structure, as kernels have them that are compiled for it.
template <Accel accel, bool instanced, bool has_masks, bool has_motion>
using Rays = Traits<accel, instanced ? Geometry::mixed : Geometry::triangles, Lighting::full,
                    has_masks, false, false, has_motion>;

template <class Result>
using Trace = Result (*)(const Scene&, const Ray&, float, std::uint32_t, float);

struct Closest {
  using Result = Hit;
  template <class Traits>
  static constexpr Trace<Hit> trace = closest_triangle<Traits>;
};

struct Any {
  using Result = bool;
  template <class Traits>
  static constexpr Trace<bool> trace = any_triangle<Traits>;
};

/// Whether plans have kernels for it (plan/kernels.h).
constexpr bool is_traced(Accel accel, bool has_masks, bool has_motion) {
  if (accel == Accel::embree) return !has_masks && !has_motion;
  return accel != Accel::cwbvh_avx2 || !has_masks;
}

/// Null where it is not traced.
template <class Query, Accel accel, bool instanced, bool has_masks, bool has_motion>
constexpr Trace<typename Query::Result> trace_of() {
  if constexpr (accel == Accel::any || !is_traced(accel, has_masks, has_motion)) {
    return nullptr;
  } else {
    return Query::template trace<Rays<accel, instanced, has_masks, has_motion>>;
  }
}

/// By structure; a function for each, so that its loop is optimised alone.
template <class Query, bool instanced, bool... extras>
constexpr auto traces_of() {
  return []<int... i>(std::integer_sequence<int, i...>) {
    return std::array{trace_of<Query, Accel{i}, instanced, extras...>()...};
  }
  (std::make_integer_sequence<int, accel_count>{});
}

template <class Query, bool... extras>
auto trace_any(const Scene& scene, const Ray& ray, float t_max, std::uint32_t ray_key, float time) {
  static constexpr auto plain = traces_of<Query, false, extras...>();
  static constexpr auto instanced = traces_of<Query, true, extras...>();
  const auto& traces = scene.triangles.instance_count > 0 ? instanced : plain;
  return traces[static_cast<std::size_t>(scene.triangles.accel)](scene, ray, t_max, ray_key, time);
}

}  // namespace

template <bool has_masks, bool has_motion>
Hit closest_triangle_any(const Scene& scene, const Ray& ray, float t_max, std::uint32_t ray_key,
                         float time) {
  return trace_any<Closest, has_masks, has_motion>(scene, ray, t_max, ray_key, time);
}

template <bool has_masks, bool has_motion>
bool any_triangle_any(const Scene& scene, const Ray& ray, float t_max, std::uint32_t ray_key,
                      float time) {
  return trace_any<Any, has_masks, has_motion>(scene, ray, t_max, ray_key, time);
}

#define PT_ANY(has_masks, has_motion)                                                       \
  template Hit closest_triangle_any<has_masks, has_motion>(const Scene&, const Ray&, float, \
                                                           std::uint32_t, float);           \
  template bool any_triangle_any<has_masks, has_motion>(const Scene&, const Ray&, float,    \
                                                        std::uint32_t, float);
PT_ANY(false, false)
PT_ANY(true, false)
PT_ANY(false, true)
PT_ANY(true, true)
#undef PT_ANY

template <class Shading>
Scattering surface_scattering_any(const Scene& scene, const Ray& ray, const Hit& hit,
                                  PathState& path, const PathSettings& settings,
                                  const EagerShading& policy) {
  return surface_scattering<Shading>(scene, ray, hit, path, settings, policy);
}

#define PT_ANY(has_media, has_motion)                                                              \
  template Scattering surface_scattering_any<                                                      \
      Traits<Accel::brute, Geometry::mixed, Lighting::full, false, has_media, false, has_motion>>( \
      const Scene&, const Ray&, const Hit&, PathState&, const PathSettings&, const EagerShading&);
PT_ANY(false, false)
PT_ANY(true, false)
PT_ANY(false, true)
PT_ANY(true, true)
#undef PT_ANY

}  // namespace pt
