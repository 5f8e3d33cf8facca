// Step 2: the ray's closest hit.
#pragma once

#include "common/accel/traverse_brute.h"
#include "common/accel/traverse_bvh2.h"
#include "common/accel/traverse_triangles.h"
#include "common/scene/data/scene.h"
#include "common/transport/mask.h"

namespace pt {

/// A shadow ray, and what it contributes if it is not occluded.
struct ShadowRay {
  Ray ray;
  float distance = 0.0f;
  Color radiance = Color(0.0f);  ///< added to the sample if not occluded; black: no shadow ray
  std::uint16_t medium_id = no_medium;  ///< where it begins (Media), in scenes with media
};

/// The spheres and quads, at a time where they move.
template <bool has_motion>
PT_HD decltype(auto) primitives_at(const Scene& scene, float time) {
  if constexpr (has_motion) {
    return MovingPrimitives{scene.primitives, *scene.motion, time};
  } else {
    return (scene.primitives);
  }
}

/// Spheres and quads, in a scene that has nothing else or besides its triangles.
template <class Traits>
PT_HD Hit closest_primitive(const Scene& scene, const Ray& ray, float time = 0.0f) {
  if constexpr (Traits::has_motion) {
    return closest_hit_bvh2(scene.bvh_nodes, primitives_at<true>(scene, time), ray);
  } else if constexpr (Traits::geometry == Geometry::mixed || Traits::accel == Accel::bvh2) {
    return closest_hit_bvh2(scene.bvh_nodes, scene.primitives, ray);
  } else {
    return closest_hit_brute(scene.primitives, ray);
  }
}

template <class Traits>
PT_HD bool any_primitive(const Scene& scene, const Ray& ray, float distance, float time = 0.0f) {
  if constexpr (Traits::has_motion) {
    return any_hit_bvh2(scene.bvh_nodes, primitives_at<true>(scene, time), ray, distance);
  } else if constexpr (Traits::geometry == Geometry::mixed || Traits::accel == Accel::bvh2) {
    return any_hit_bvh2(scene.bvh_nodes, scene.primitives, ray, distance);
  } else {
    return any_hit_brute(scene.primitives, ray, distance);
  }
}

/// In a scene with masks: within the view, for a camera ray.
template <bool has_motion = false>
PT_HD Hit closest_primitive_in_view(const Scene& scene, const Ray& ray, std::uint32_t ray_key,
                                    float time = 0.0f) {
  const bool is_limited = is_limited_camera_ray(scene, ray_key);
  Hit hit;
  hit.t = ray_length<has_motion>(scene, ray.direction, ray_key, time);
  traverse_bvh2(scene.bvh_nodes, primitives_at<has_motion>(scene, time), ray, hit.t,
                [&](float t, std::uint32_t primitive, float& t_max) {
                  const bool hidden =
                      is_limited &&
                      scene.opacities[scene.material_of[primitive]].hides_from_camera();
                  if (!hidden) keep_nearer(hit, t, primitive);
                  t_max = hit.t;
                  return false;
                });
  return hit.is_miss() ? Hit() : hit;
}

// In the structure that the scene names, on the CPU alone: compiled once, for kernels of any
// structure (any_structure.cpp).
template <bool has_masks, bool has_motion>
Hit closest_triangle_any(const Scene& scene, const Ray& ray, float t_max, std::uint32_t ray_key,
                         float time);
template <bool has_masks, bool has_motion>
bool any_triangle_any(const Scene& scene, const Ray& ray, float t_max, std::uint32_t ray_key,
                      float time);

/// Both among the triangles; `ray_key` is for masks, `time` for what moves.
template <class Traits>
PT_HD Hit closest_triangle(const Scene& scene, const Ray& ray, float t_max, std::uint32_t ray_key,
                           float time) {
  if constexpr (Traits::accel == Accel::any) {
    return closest_triangle_any<Traits::has_masks, Traits::has_motion>(scene, ray, t_max, ray_key,
                                                                       time);
  } else if constexpr (Traits::has_motion && Traits::has_masks) {
    MaskedQuery<MovingQuery<ClosestTriangle>, MaskTest> query(0.0f, t_max, MaskTest{scene, ray_key},
                                                              *scene.motion, time);
    traverse_triangles<Traits::accel, Traits::has_instances>(scene.triangles, ray, query);
    return query.result();
  } else if constexpr (Traits::has_motion) {
    MovingQuery<ClosestTriangle> query(0.0f, t_max, *scene.motion, time);
    traverse_triangles<Traits::accel, Traits::has_instances>(scene.triangles, ray, query);
    return query.result();
  } else if constexpr (Traits::has_masks) {
    MaskedQuery<ClosestTriangle, MaskTest> query(0.0f, t_max, {scene, ray_key});
    traverse_triangles<Traits::accel, Traits::has_instances>(scene.triangles, ray, query);
    return query.result();
  } else {
    return closest_triangle<Traits::accel, Traits::has_instances>(scene.triangles, ray, 0.0f,
                                                                  t_max);
  }
}

template <class Traits>
PT_HD bool any_triangle(const Scene& scene, const Ray& ray, float t_max, std::uint32_t ray_key,
                        float time) {
  if constexpr (Traits::accel == Accel::any) {
    return any_triangle_any<Traits::has_masks, Traits::has_motion>(scene, ray, t_max, ray_key,
                                                                   time);
  } else if constexpr (Traits::has_motion && Traits::has_masks) {
    MaskedQuery<MovingQuery<AnyTriangle>, MaskTest> query(0.0f, t_max, MaskTest{scene, ray_key},
                                                          *scene.motion, time);
    traverse_triangles<Traits::accel, Traits::has_instances>(scene.triangles, ray, query);
    return query.result();
  } else if constexpr (Traits::has_motion) {
    MovingQuery<AnyTriangle> query(0.0f, t_max, *scene.motion, time);
    traverse_triangles<Traits::accel, Traits::has_instances>(scene.triangles, ray, query);
    return query.result();
  } else if constexpr (Traits::has_masks) {
    MaskedQuery<AnyTriangle, MaskTest> query(0.0f, t_max, {scene, ray_key});
    traverse_triangles<Traits::accel, Traits::has_instances>(scene.triangles, ray, query);
    return query.result();
  } else {
    return any_triangle<Traits::accel, Traits::has_instances>(scene.triangles, ray, 0.0f, t_max);
  }
}

/// Whether others trace the rays (OptiX, in the megakernel that it runs), in a scene that has
/// triangles alone:
///   static Hit Traits::Tracer::closest(const Scene&, const Ray&, std::uint32_t ray_key)
///   static bool Traits::Tracer::any(const ShadowRay&, std::uint32_t ray_key)
template <class Traits>
concept HasTracer = requires {
  typename Traits::Tracer;
};

/// `ray_key` (next_ray_key) decides what masks let through; read in scenes with masks alone. `time`
/// is the path's, read in scenes that move alone.
template <class Traits>
PT_HD Hit intersect_closest(const Scene& scene, const Ray& ray, std::uint32_t ray_key = 0,
                            float time = 0.0f) {
  lanes_of(ray).count(LanePoint::intersect);
  if constexpr (HasTracer<Traits>) {
    return Traits::Tracer::closest(scene, ray, ray_key);
  } else if constexpr (Traits::geometry == Geometry::spheres_and_quads) {
    return closest_primitive<Traits>(scene, ray);
  } else {
    Hit nearest;
    float t_max = nearest.t;
    if constexpr (Traits::has_masks) {
      constexpr bool has_motion = Traits::has_motion;
      if (scene.primitives.count() > 0)
        nearest = closest_primitive_in_view<has_motion>(scene, ray, ray_key, time);
      t_max = nearest.is_miss() ? ray_length<has_motion>(scene, ray.direction, ray_key, time)
                                : nearest.t;
    } else if (Traits::geometry == Geometry::mixed && scene.primitives.count() > 0) {
      nearest = closest_primitive<Traits>(scene, ray, time);
      t_max = nearest.t;
    }
    Hit hit = closest_triangle<Traits>(scene, ray, t_max, ray_key, time);
    if (hit.is_miss()) return nearest;
    hit.primitive += scene.primitives.count();
    return hit;
  }
}

/// True when something lies between the shadow ray's ends. `ray_key`: shadow_ray_key.
template <class Traits>
PT_HD bool intersect_shadow(const Scene& scene, const ShadowRay& shadow, std::uint32_t ray_key = 0,
                            float time = 0.0f) {
  lanes_of(shadow.ray).count(LanePoint::intersect);
  if constexpr (HasTracer<Traits>) {
    return Traits::Tracer::any(shadow, ray_key);
  } else if constexpr (Traits::geometry == Geometry::spheres_and_quads) {
    return any_primitive<Traits>(scene, shadow.ray, shadow.distance);
  } else {
    if (Traits::geometry == Geometry::mixed && scene.primitives.count() > 0 &&
        any_primitive<Traits>(scene, shadow.ray, shadow.distance, time)) {
      return true;
    }
    return any_triangle<Traits>(scene, shadow.ray, shadow.distance, ray_key, time);
  }
}

}  // namespace pt
