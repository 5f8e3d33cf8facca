// What OptiX's programs know of a scene, how far a traversal looks, and what a ray carries through
// them; for host and device.
#pragma once

#include <cstring>
#include <type_traits>

#include "common/accel/trace_optix/optix_abi.h"
#include "common/accel/triangle_query.h"
#include "common/geometry/primitives.h"

namespace pt {

struct OptixScene {
  TriangleTree tree;
  optix::TraversableHandle handle = 0;
  float cull_margin = 0;  ///< OptixReach
  Vec3 centre{0.0f};
  float reach = 0;
  Primitives primitives;                      ///< spheres alone
  const Bvh2Node* primitive_nodes = nullptr;  ///< our tree over them
};

/// What a scene's structure has besides triangles in world space.
struct OptixContent {
  bool has_instances = false;  ///< OptiX's
  bool has_spheres = false;    ///< boxes of an instance of their own, whose records are others
};

/// Hit::instance where a query has met a sphere, whose number is Hit::primitive.
inline constexpr std::uint32_t sphere_instance = 0xffffffffu;

/// Of triangles and spheres: where both are met at the same t the sphere wins, then the lower
/// number, as in transport/intersect.h.
class ClosestSurface : public ClosestTriangle {
 public:
  using ClosestTriangle::ClosestTriangle;

  PT_HD bool offer(const TriangleTree& tree, float t, std::uint32_t slot, std::uint32_t instance) {
    if (result().instance == sphere_instance && !(t < t_max())) return false;
    return ClosestTriangle::offer(tree, t, slot, instance);
  }
  PT_HD bool offer_sphere(float t, std::uint32_t sphere) {
    const Hit best = result();
    const bool wins_tie = best.instance != sphere_instance || sphere < best.primitive;
    if (!(t > t_min() && (t < t_max() || (t == t_max() && wins_tie)))) return false;
    ClosestTriangle met(t_min(), HUGE_VALF);
    met.offer({}, t, sphere, sphere_instance);
    ClosestTriangle::operator=(met);
    return false;
  }
};

class AnySurface : public AnyTriangle {
 public:
  using AnyTriangle::AnyTriangle;

  PT_HD bool offer_sphere(float t, std::uint32_t) { return offer({}, t, 0, 0); }
};

/// A query's hit as the scene numbers it.
PT_HD Hit numbered(const OptixScene& scene, const Hit& hit) {
  if (hit.is_miss()) return hit;
  if (hit.instance == sphere_instance) return {hit.t, hit.primitive, 0};
  return {hit.t, hit.primitive + scene.primitives.count(), hit.instance};
}

/// Whether the ray begins so far outside that rounding moves its hits by more than the margins of
/// boxes. Such rays, of distant cameras, are traced through our own tree.
PT_HD bool begins_too_far(const OptixScene& scene, const Ray& ray) {
  return !(max_abs(ray.origin - scene.centre) <= scene.reach);
}

/// The interval of boxes that OptiX must visit for hits with t_min < t < t_max: our bounds on where
/// a ray enters and leaves the box of a triangle that is met (docs/design/tracing.md), with much to
/// spare for OptiX's own rounding.
inline constexpr float optix_tolerance = 128.0f * half_ulp;

PT_HD float optix_cull_margin(const OptixScene& scene, const Ray& ray) {
  return scene.cull_margin / max_abs(ray.direction);
}
PT_HD float optix_t_max(float t_max, float margin) {
  return min_number(t_max * (1.0f + optix_tolerance) + margin, infinite_distance);
}
PT_HD float optix_t_min(float t_min, float margin) {
  return max_number(t_min * (1.0f - optix_tolerance) - margin, 0.0f);
}

/// Offers the triangle that OptiX names to the query; true: there is no need to look any further.
template <class Query>
PT_HD bool offer_candidate(const TriangleTree& tree, const Ray& ray, std::uint32_t primitive,
                           std::uint32_t instance, Query& query) {
  if (tree.instance_count == 0) {
    return offer_slots(tree, make_triangle_ray(ray.origin, ray.direction), primitive, 1, query);
  }
  const InstanceRecord record = load_wide(&tree.instances[instance]);
  const InstanceVisit visit =
      visit_instance(record, ray, make_slab_test_ray(ray), query.t_min(), query.t_max());
  if (visit.is_empty) return false;
  const std::uint32_t slot = record.first_slot + primitive;
  const Triangle triangle = load_wide(&tree.triangles[slot]);
  const TriangleHit hit =
      intersect_triangle(make_triangle_ray(visit.ray.origin, visit.ray.direction), triangle.v0,
                         triangle.v1, triangle.v2);
  // By its bits: OptiX's compiler makes minima and maxima of moved(), which take NaN for a number.
  if ((float_to_bits(hit.t) & 0x7fffffffu) > 0x7f800000u) return false;
  const float t = visit.moved(hit.t);
  if constexpr (Query::has_masks) {
    if (query.hides(triangle, hit, t, instance)) return false;
  }
  return query.offer(tree, t, slot, instance);
}

/// How many words a ray carries: a query of triangle_query.h and the ray as it was traced, word by
/// word: OptiX need not give back the same bits.
inline constexpr int optix_query_words = 5, optix_payload_words = optix_query_words + 6;

/// Records of the hit programs, counted from the first of triangles or of spheres (OptixPipeline).
enum OptixRecord : unsigned { optix_record_closest, optix_record_any, optix_record_ties };
inline constexpr unsigned optix_records = 3;

struct OptixPayload {
  std::uint32_t word[optix_payload_words];
};

template <class Query>
PT_HD OptixPayload to_payload(const Query& query, const Ray& ray = {}) {
  static_assert(std::is_trivially_copyable_v<Query> && sizeof(Query) <= 4 * optix_query_words);
  OptixPayload payload{};
  memcpy(&payload, static_cast<const void*>(&query), sizeof query);
  for (int i = 0; i < 3; ++i) {
    payload.word[optix_query_words + i] = float_to_bits(ray.origin[i]);
    payload.word[optix_query_words + 3 + i] = float_to_bits(ray.direction[i]);
  }
  return payload;
}

/// `query`: any, whose place is taken.
template <class Query>
PT_HD void from_payload(const OptixPayload& payload, Query& query) {
  memcpy(static_cast<void*>(&query), &payload, sizeof query);
}

}  // namespace pt
