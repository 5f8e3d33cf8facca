// The programs that OptiX runs: for each kind of OptixHits those that judge its candidates, and
// what a ray generation program calls to trace a ray.
//
// `Api` has OptiX's functions: DeviceApi (optix_intrinsics.cuh), or those of a test that emulates
// OptiX on the host. PT_OPTIX_FUNCTION is how its functions are declared.
#pragma once

#include "common/accel/trace_optix/optix_scene.h"
#include "common/accel/traverse_bvh2.h"
#include "common/accel/traverse_cwbvh.h"
#include "common/choices/optix_hits.h"

#ifndef PT_OPTIX_FUNCTION
#define PT_OPTIX_FUNCTION inline
#endif

namespace pt {

/// A query that asks the scene's masks, by the key of the ray: judged_mask_hides
/// (transport/mask.h), which is not part of each program, since masks are rare and their code is
/// long. Besides OptiX's functions `Api` has world(), the Scene, and masks(), its MaskView.
template <class Api, class Query>
class JudgingQuery : public Query {
 public:
  static constexpr bool has_masks = true;

  PT_HD JudgingQuery(float t_min, float t_max, std::uint32_t key = 0)
      : Query(t_min, t_max), key_(key) {}

  PT_OPTIX_FUNCTION bool hides(const Triangle& triangle, const TriangleHit& hit, float t,
                               std::uint32_t instance) const {
    if (!is_up_to_mask(*this, triangle, t)) return false;
    const TriangleTree& tree = Api::world().triangles;
    const std::uint32_t index = tree.instance_count > 0 ? tree.instances[instance].index : 0;
    return judged_mask_hides(Api::masks(), key_, triangle, hit.b1, hit.b2, index);
  }
  PT_OPTIX_FUNCTION bool hides_sphere(std::uint32_t sphere) const {
    const auto& world = Api::world();
    return is_limited_camera_ray(world, key_) &&
           world.opacities[world.material_of[sphere]].hides_from_camera();
  }

 private:
  std::uint32_t key_;
};
template <class Api>
using ClosestJudge = JudgingQuery<Api, ClosestSurface>;
template <class Api>
using AnyJudge = JudgingQuery<Api, AnySurface>;

}  // namespace pt

namespace pt::optix {

/// OptixPayload of the program that runs.
template <class Api, class Query>
PT_OPTIX_FUNCTION void load_query(Query& query) {
  OptixPayload payload;
  for (int i = 0; i < optix_query_words; ++i) payload.word[i] = Api::payload_word(i);
  from_payload(payload, query);
}

/// The ray as it was traced.
template <class Api>
PT_OPTIX_FUNCTION Ray load_ray() {
  const auto number = [](int i) { return bits_to_float(Api::payload_word(optix_query_words + i)); };
  return {{number(0), number(1), number(2)}, {number(3), number(4), number(5)}};
}

template <class Api, class Query>
PT_OPTIX_FUNCTION void store_query(const Query& query) {
  const OptixPayload payload = to_payload(query);
  for (int i = 0; i < static_cast<int>(sizeof(Query) / 4); ++i)
    Api::set_payload_word(i, payload.word[i]);
}

template <class Api>
PT_OPTIX_FUNCTION std::uint32_t named_instance(const TriangleTree& tree) {
  return tree.instance_count == 0 ? 0 : Api::instance_id();
}

template <class Api, class Query>
PT_OPTIX_FUNCTION bool offer_named(const TriangleTree& tree, Query& query) {
  return offer_candidate(tree, load_ray<Api>(), Api::primitive_index(), named_instance<Api>(tree),
                         query);
}

/// Offers the sphere, which OptiX numbers as we do.
template <class Api, class Query>
PT_OPTIX_FUNCTION bool offer_sphere(const OptixScene& scene, const Ray& ray, std::uint32_t sphere,
                                    Query& query) {
  if constexpr (Query::has_masks) {
    if (query.hides_sphere(sphere)) return false;
  }
  return query.offer_sphere(sphere_distance(load_wide(&scene.primitives.spheres[sphere]), ray),
                            sphere);
}

/// Offers what OptiX names, in a program for spheres or for triangles.
template <class Api, bool is_sphere, class Query>
PT_OPTIX_FUNCTION bool offer_box(const OptixScene& scene, Query& query) {
  if constexpr (is_sphere)
    return offer_sphere<Api>(scene, load_ray<Api>(), Api::primitive_index(), query);
  return offer_named<Api>(scene.tree, query);
}

/// Reports where OptiX may stop to look, not where the hit is: others at the same distance must
/// still be offered.
template <class Api, class Query, bool is_sphere = false>
PT_OPTIX_FUNCTION void intersect_closest_box(const OptixScene& scene) {
  Query query(0.0f, 0.0f);
  load_query<Api>(query);
  const float before = query.t_max();
  offer_box<Api, is_sphere>(scene, query);
  if (!(query.t_max() < before)) return store_query<Api>(query);
  store_query<Api>(query);
  Api::report_intersection(optix_t_max(query.t_max(), optix_cull_margin(scene, load_ray<Api>())));
}

/// With ray_terminate_on_first_hit, or a program that does so.
template <class Api, class Query, bool is_sphere = false>
PT_OPTIX_FUNCTION void intersect_any_box(const OptixScene& scene) {
  Query query(0.0f, 0.0f);
  load_query<Api>(query);
  if (!offer_box<Api, is_sphere>(scene, query)) return;
  store_query<Api>(query);
  Api::report_intersection(Api::ray_t_max());
}

/// Where OptiX decides: it takes the distance for its own.
template <class Api>
PT_OPTIX_FUNCTION void report_sphere(const OptixScene& scene) {
  const float t = sphere_distance(load_wide(&scene.primitives.spheres[Api::primitive_index()]),
                                  load_ray<Api>());
  if (t > 0.0f) Api::report_intersection(t);
}

/// First of two traces: a triangle is accepted, which ends OptiX's interval where it is, if it is
/// nearer than the others before.
template <class Api, class Query>
PT_OPTIX_FUNCTION void accept_closest(const OptixScene& scene) {
  Query query(0.0f, 0.0f);
  load_query<Api>(query);
  const float before = query.t_max();
  offer_named<Api>(scene.tree, query);
  store_query<Api>(query);
  if (!(query.t_max() < before)) Api::ignore_intersection();
}

/// Second trace, up to the hit of the first: every triangle is judged, none ends the interval.
template <class Api, class Query>
PT_OPTIX_FUNCTION void judge_all(const OptixScene& scene) {
  Query query(0.0f, 0.0f);
  load_query<Api>(query);
  offer_named<Api>(scene.tree, query);
  store_query<Api>(query);
  Api::ignore_intersection();
}

template <class Api, class Query>
PT_OPTIX_FUNCTION void accept_any(const OptixScene& scene) {
  Query query(0.0f, 0.0f);
  load_query<Api>(query);
  if (!offer_named<Api>(scene.tree, query)) return Api::ignore_intersection();
  store_query<Api>(query);
  Api::terminate_ray();
}

/// OptiX's own hit, as words of a Hit.
template <class Api>
PT_OPTIX_FUNCTION void name_hit(const OptixScene& scene) {
  const std::uint32_t instance = named_instance<Api>(scene.tree);
  const std::uint32_t first =
      scene.tree.instance_count == 0 ? 0 : scene.tree.instances[instance].first_slot;
  store_query<Api>(Hit{Api::ray_t_max(), first + Api::primitive_index(), instance});
}
template <class Api>
PT_OPTIX_FUNCTION void name_sphere() {
  store_query<Api>(Hit{Api::ray_t_max(), Api::primitive_index(), sphere_instance});
}

/// Through our own trees.
template <class Api, class Query>
PT_OPTIX_FUNCTION Query trace_far(const OptixScene& scene, const Ray& ray, Query query) {
  if (scene.primitives.count() > 0) {
    const auto visit = [&](float, std::uint32_t sphere, float& t_max) {
      const bool ends = offer_sphere<Api>(scene, ray, sphere, query);
      t_max = query.t_max();
      return ends;
    };
    if (traverse_bvh2(scene.primitive_nodes, scene.primitives, ray, query.t_max(), visit))
      return query;
  }
  traverse_cwbvh<true>(scene.tree, ray, query);
  return query;
}

/// What was found, as the scene numbers it.
PT_OPTIX_FUNCTION Hit answer(const OptixScene& scene, const Hit& hit) {
  return numbered(scene, hit);
}
PT_OPTIX_FUNCTION bool answer(const OptixScene&, bool met) { return met; }

/// Whether rays from far away pass through our own tree, not through OptiX's structure.
constexpr bool has_far_rays(OptixHits hits) { return hits != OptixHits::built_in; }

/// By OptiX; `query` is fresh. The hit is that of our tests; with OptixHits::built_in OptiX's
/// distance stays where our test finds that its triangle is missed.
template <class Api, OptixHits hits, class Query>
PT_OPTIX_FUNCTION Hit trace_near_closest(const OptixScene& scene, const Ray& ray, Query query) {
  const float margin = optix_cull_margin(scene, ray);
  const float t_min = optix_t_min(query.t_min(), margin);
  const float t_max = optix_t_max(query.t_max(), margin);
  if constexpr (hits == OptixHits::built_in) {
    OptixPayload payload = to_payload(Hit(), ray);
    Api::trace(scene.handle, ray, query.t_min(), query.t_max(), ray_disable_anyhit,
               optix_record_closest, payload);
    Hit hit;
    from_payload(payload, hit);
    if (hit.is_miss() || hit.instance == sphere_instance) return hit;
    const std::uint32_t first =
        scene.tree.instance_count == 0 ? 0 : scene.tree.instances[hit.instance].first_slot;
    offer_candidate(scene.tree, ray, hit.primitive - first, hit.instance, query);
    const Hit ours = query.result();
    return ours.is_miss() ? hit : ours;
  } else {
    OptixPayload payload = to_payload(query, ray);
    Api::trace(scene.handle, ray, t_min, t_max,
               hits == OptixHits::custom ? ray_disable_anyhit | ray_disable_closesthit
                                         : ray_disable_closesthit,
               optix_record_closest, payload);
    from_payload(payload, query);
    if (hits == OptixHits::any_hit && !query.result().is_miss()) {
      Api::trace(scene.handle, ray, t_min, optix_t_max(query.t_max(), margin),
                 ray_disable_closesthit, optix_record_ties, payload);
      from_payload(payload, query);
    }
    return query.result();
  }
}

/// Whether anything is met, likewise.
template <class Api, OptixHits hits, class Query>
PT_OPTIX_FUNCTION bool trace_near_any(const OptixScene& scene, const Ray& ray, Query query) {
  const float margin = optix_cull_margin(scene, ray);
  if constexpr (hits == OptixHits::built_in) {
    OptixPayload payload = to_payload(Hit(), ray);
    Api::trace(scene.handle, ray, query.t_min(), query.t_max(),
               ray_disable_anyhit | ray_terminate_on_first_hit, optix_record_any, payload);
    Hit hit;
    from_payload(payload, hit);
    return !hit.is_miss();
  } else {
    OptixPayload payload = to_payload(query, ray);
    Api::trace(scene.handle, ray, optix_t_min(query.t_min(), margin),
               optix_t_max(query.t_max(), margin),
               hits == OptixHits::custom
                   ? ray_disable_anyhit | ray_disable_closesthit | ray_terminate_on_first_hit
                   : ray_disable_closesthit,
               optix_record_any, payload);
    from_payload(payload, query);
    return query.result();
  }
}

/// What `near` gives, or what our own trees do for a ray from far away.
template <class Api, class Query, class Near>
PT_OPTIX_FUNCTION auto trace_any_distance(bool has_far_rays, const OptixScene& scene,
                                          const Ray& ray, Query query, Near&& near)
    -> decltype(near()) {
  if (!is_traceable(ray)) return {};
  if (has_far_rays && begins_too_far(scene, ray))
    return answer(scene, trace_far<Api>(scene, ray, query).result());
  return answer(scene, near());
}

template <class Api, OptixHits hits, class Query>
PT_OPTIX_FUNCTION Hit trace_closest(const OptixScene& scene, const Ray& ray, Query query) {
  return trace_any_distance<Api>(has_far_rays(hits), scene, ray, query,
                                 [&] { return trace_near_closest<Api, hits>(scene, ray, query); });
}

template <class Api, OptixHits hits, class Query>
PT_OPTIX_FUNCTION bool trace_any(const OptixScene& scene, const Ray& ray, Query query) {
  return trace_any_distance<Api>(has_far_rays(hits), scene, ray, query,
                                 [&] { return trace_near_any<Api, hits>(scene, ray, query); });
}

}  // namespace pt::optix

/// The programs that judge, for a module whose OptixScene is `scene`, in constant memory.
#define PT_OPTIX_HIT_PROGRAMS(Api, Closest, Any, scene)                                         \
  extern "C" __global__ void __intersection__closest() {                                        \
    pt::optix::intersect_closest_box<Api, Closest>(scene);                                      \
  }                                                                                             \
  extern "C" __global__ void __intersection__any() {                                            \
    pt::optix::intersect_any_box<Api, Any>(scene);                                              \
  }                                                                                             \
  extern "C" __global__ void __anyhit__closest() {                                              \
    pt::optix::accept_closest<Api, Closest>(scene);                                             \
  }                                                                                             \
  extern "C" __global__ void __anyhit__ties() { pt::optix::judge_all<Api, Closest>(scene); }    \
  extern "C" __global__ void __anyhit__any() { pt::optix::accept_any<Api, Any>(scene); }        \
  extern "C" __global__ void __closesthit__name() { pt::optix::name_hit<Api>(scene); }          \
  extern "C" __global__ void __intersection__closest_sphere() {                                 \
    pt::optix::intersect_closest_box<Api, Closest, true>(scene);                                \
  }                                                                                             \
  extern "C" __global__ void __intersection__any_sphere() {                                     \
    pt::optix::intersect_any_box<Api, Any, true>(scene);                                        \
  }                                                                                             \
  extern "C" __global__ void __intersection__sphere() { pt::optix::report_sphere<Api>(scene); } \
  extern "C" __global__ void __anyhit__end() { Api::terminate_ray(); }                          \
  extern "C" __global__ void __closesthit__name_sphere() { pt::optix::name_sphere<Api>(); }
