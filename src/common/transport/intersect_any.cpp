#include <array>
#include <utility>

#include "common/transport/intersect.h"

namespace pt {
namespace {

/// A scene's rays in one structure, as kernels have them that are compiled for it.
template <Accel accel, bool instanced, bool has_masks>
using Rays =
    Traits<accel, instanced ? Geometry::mixed : Geometry::triangles, Lighting::full, has_masks>;

template <class Traits>
struct Closest {
  using Result = Hit;
  static Hit trace(const Scene& scene, const Ray& ray, float t_max, std::uint32_t ray_key) {
    return closest_triangle<Traits>(scene, ray, t_max, ray_key);
  }
};

template <class Traits>
struct Any {
  using Result = bool;
  static bool trace(const Scene& scene, const Ray& ray, float t_max, std::uint32_t ray_key) {
    return any_triangle<Traits>(scene, ray, t_max, ray_key);
  }
};

template <class Result>
using Trace = Result (*)(const Scene&, const Ray&, float, std::uint32_t);

/// Null where no plan has it: kernels with masks are of few structures (plan/kernels.h).
template <template <class> class Query, Accel accel, bool instanced, bool has_masks>
constexpr auto trace_of() {
  using Kind = Query<Rays<accel, instanced, has_masks>>;
  constexpr bool is_unmasked = accel == Accel::embree || accel == Accel::cwbvh_avx2;
  if constexpr (accel == Accel::any || (has_masks && is_unmasked)) {
    return Trace<typename Kind::Result>{nullptr};
  } else {
    return &Kind::trace;
  }
}

/// By structure; a function for each, so that its loop is optimised alone.
template <template <class> class Query, bool instanced, bool has_masks>
constexpr auto traces_of() {
  return []<int... i>(std::integer_sequence<int, i...>) {
    return std::array{trace_of<Query, Accel{i}, instanced, has_masks>()...};
  }
  (std::make_integer_sequence<int, accel_count>{});
}

template <template <class> class Query, bool has_masks>
auto trace_any(const Scene& scene, const Ray& ray, float t_max, std::uint32_t ray_key) {
  static constexpr auto plain = traces_of<Query, false, has_masks>();
  static constexpr auto instanced = traces_of<Query, true, has_masks>();
  const auto& traces = scene.triangles.instance_count > 0 ? instanced : plain;
  return traces[static_cast<std::size_t>(scene.triangles.accel)](scene, ray, t_max, ray_key);
}

}  // namespace

template <bool has_masks>
Hit closest_triangle_any(const Scene& scene, const Ray& ray, float t_max, std::uint32_t ray_key) {
  return trace_any<Closest, has_masks>(scene, ray, t_max, ray_key);
}

template <bool has_masks>
bool any_triangle_any(const Scene& scene, const Ray& ray, float t_max, std::uint32_t ray_key) {
  return trace_any<Any, has_masks>(scene, ray, t_max, ray_key);
}

template Hit closest_triangle_any<false>(const Scene&, const Ray&, float, std::uint32_t);
template Hit closest_triangle_any<true>(const Scene&, const Ray&, float, std::uint32_t);
template bool any_triangle_any<false>(const Scene&, const Ray&, float, std::uint32_t);
template bool any_triangle_any<true>(const Scene&, const Ray&, float, std::uint32_t);

}  // namespace pt
