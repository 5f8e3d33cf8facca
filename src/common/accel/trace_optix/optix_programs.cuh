// The programs that OptiX runs: for each kind of OptixHits those that judge its candidates, and
// what a ray generation program calls to trace a ray.
#pragma once

#include "common/accel/trace_optix/optix_intrinsics.cuh"
#include "common/accel/trace_optix/optix_scene.h"
#include "common/choices/optix_hits.h"

namespace pt::optix {

/// OptixPayload of the program that runs.
template <class Query>
__device__ __forceinline__ void load_query(Query& query) {
  OptixPayload payload;
  for (int i = 0; i < optix_payload_words; ++i) payload.word[i] = payload_word(i);
  from_payload(payload, query);
}

template <class Query>
__device__ __forceinline__ void store_query(const Query& query) {
  const OptixPayload payload = to_payload(query);
  for (int i = 0; i < static_cast<int>(sizeof(Query) / 4); ++i)
    set_payload_word(i, payload.word[i]);
}

__device__ __forceinline__ std::uint32_t named_instance(const TriangleTree& tree) {
  return tree.instance_count == 0 ? 0 : instance_id();
}

template <class Query>
__device__ __forceinline__ bool offer_named(const TriangleTree& tree, Query& query) {
  return offer_candidate(tree, world_ray(), primitive_index(), named_instance(tree), query);
}

/// Reports where OptiX may stop to look, not where the hit is: others at the same distance must
/// still be offered.
template <class Query>
__device__ __forceinline__ void intersect_closest_box(const OptixScene& scene) {
  Query query(0.0f, 0.0f);
  load_query(query);
  const float before = query.t_max();
  offer_named(scene.tree, query);
  if (!(query.t_max() < before)) return store_query(query);
  store_query(query);
  report_intersection(optix_t_max(query.t_max(), optix_cull_margin(scene, world_ray())));
}

/// With ray_terminate_on_first_hit.
template <class Query>
__device__ __forceinline__ void intersect_any_box(const OptixScene& scene) {
  Query query(0.0f, 0.0f);
  load_query(query);
  if (!offer_named(scene.tree, query)) return;
  store_query(query);
  report_intersection(ray_t_max());
}

/// First of two traces: a triangle is accepted, which ends OptiX's interval where it is, if it is
/// nearer than the others before.
template <class Query>
__device__ __forceinline__ void accept_closest(const OptixScene& scene) {
  Query query(0.0f, 0.0f);
  load_query(query);
  const float before = query.t_max();
  offer_named(scene.tree, query);
  store_query(query);
  if (!(query.t_max() < before)) ignore_intersection();
}

/// Second trace, up to the hit of the first: every triangle is judged, none ends the interval.
template <class Query>
__device__ __forceinline__ void judge_all(const OptixScene& scene) {
  Query query(0.0f, 0.0f);
  load_query(query);
  offer_named(scene.tree, query);
  store_query(query);
  ignore_intersection();
}

template <class Query>
__device__ __forceinline__ void accept_any(const OptixScene& scene) {
  Query query(0.0f, 0.0f);
  load_query(query);
  if (!offer_named(scene.tree, query)) return ignore_intersection();
  store_query(query);
  terminate_ray();
}

/// OptiX's own hit, as words of a Hit.
__device__ __forceinline__ void name_hit(const OptixScene& scene) {
  const std::uint32_t instance = named_instance(scene.tree);
  const std::uint32_t first =
      scene.tree.instance_count == 0 ? 0 : scene.tree.instances[instance].first_slot;
  store_query(Hit{ray_t_max(), first + primitive_index(), instance});
}

/// `query` is fresh. The hit is that of our tests; with OptixHits::built_in OptiX's distance stays
/// where our test finds that its triangle is missed.
template <OptixHits hits, class Query>
__device__ __forceinline__ Hit trace_closest(const OptixScene& scene, const Ray& ray, Query query) {
  if (!is_traceable(ray)) return {};
  const float margin = optix_cull_margin(scene, ray);
  const float t_min = optix_t_min(query.t_min(), margin);
  const float t_max = optix_t_max(query.t_max(), margin);
  if constexpr (hits == OptixHits::built_in) {
    OptixPayload payload = to_payload(Hit());
    trace(scene.handle, ray, query.t_min(), query.t_max(), ray_disable_anyhit, optix_record_closest,
          payload);
    Hit hit;
    from_payload(payload, hit);
    if (hit.is_miss()) return hit;
    const std::uint32_t first =
        scene.tree.instance_count == 0 ? 0 : scene.tree.instances[hit.instance].first_slot;
    offer_candidate(scene.tree, ray, hit.primitive - first, hit.instance, query);
    const Hit ours = query.result();
    return ours.is_miss() ? hit : ours;
  } else {
    OptixPayload payload = to_payload(query);
    trace(scene.handle, ray, t_min, t_max,
          hits == OptixHits::custom ? ray_disable_anyhit | ray_disable_closesthit
                                    : ray_disable_closesthit,
          optix_record_closest, payload);
    from_payload(payload, query);
    if (hits == OptixHits::any_hit && !query.result().is_miss()) {
      trace(scene.handle, ray, t_min, optix_t_max(query.t_max(), margin), ray_disable_closesthit,
            optix_record_ties, payload);
      from_payload(payload, query);
    }
    return query.result();
  }
}

/// Whether anything is met.
template <OptixHits hits, class Query>
__device__ __forceinline__ bool trace_any(const OptixScene& scene, const Ray& ray, Query query) {
  if (!is_traceable(ray)) return false;
  const float margin = optix_cull_margin(scene, ray);
  if constexpr (hits == OptixHits::built_in) {
    OptixPayload payload = to_payload(Hit());
    trace(scene.handle, ray, query.t_min(), query.t_max(),
          ray_disable_anyhit | ray_terminate_on_first_hit, optix_record_any, payload);
    Hit hit;
    from_payload(payload, hit);
    return !hit.is_miss();
  } else {
    OptixPayload payload = to_payload(query);
    trace(scene.handle, ray, optix_t_min(query.t_min(), margin), optix_t_max(query.t_max(), margin),
          hits == OptixHits::custom
              ? ray_disable_anyhit | ray_disable_closesthit | ray_terminate_on_first_hit
              : ray_disable_closesthit,
          optix_record_any, payload);
    from_payload(payload, query);
    return query.result();
  }
}

}  // namespace pt::optix

/// The programs that judge, for a module whose launch parameters begin with `scene`, an OptixScene.
#define PT_OPTIX_HIT_PROGRAMS(Closest, Any)                                                    \
  extern "C" __global__ void __intersection__closest() {                                       \
    pt::optix::intersect_closest_box<Closest>(params.scene);                                   \
  }                                                                                            \
  extern "C" __global__ void __intersection__any() {                                           \
    pt::optix::intersect_any_box<Any>(params.scene);                                           \
  }                                                                                            \
  extern "C" __global__ void __anyhit__closest() {                                             \
    pt::optix::accept_closest<Closest>(params.scene);                                          \
  }                                                                                            \
  extern "C" __global__ void __anyhit__ties() { pt::optix::judge_all<Closest>(params.scene); } \
  extern "C" __global__ void __anyhit__any() { pt::optix::accept_any<Any>(params.scene); }     \
  extern "C" __global__ void __closesthit__name() { pt::optix::name_hit(params.scene); }
