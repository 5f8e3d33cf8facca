// Step 2: what does the ray meet?
#pragma once

#include "common/accel/traverse_brute.h"
#include "common/accel/traverse_bvh2.h"
#include "common/accel/traverse_triangles.h"
#include "common/scene/scene.h"

namespace pt {

/// A question to a light: does anything lie between, and if not, what arrives?
struct ShadowRay {
  Ray ray;
  float distance = 0.0f;
  Color radiance =
      Color(0.0f);  ///< added to the pixel's sample if the ray is free; black: no question
};

/// Spheres and quads, in a scene that has nothing else or besides its triangles.
template <class Traits>
PT_HD Hit closest_primitive(const Scene& scene, const Ray& ray) {
  if constexpr (Traits::geometry == Geometry::mixed || Traits::accel == Accel::bvh2) {
    return closest_hit_bvh2(scene.bvh_nodes, scene.primitives, ray);
  } else {
    return closest_hit_brute(scene.primitives, ray);
  }
}

template <class Traits>
PT_HD bool any_primitive(const Scene& scene, const Ray& ray, float distance) {
  if constexpr (Traits::geometry == Geometry::mixed || Traits::accel == Accel::bvh2) {
    return any_hit_bvh2(scene.bvh_nodes, scene.primitives, ray, distance);
  } else {
    return any_hit_brute(scene.primitives, ray, distance);
  }
}

template <class Traits>
PT_HD Hit intersect_closest(const Scene& scene, const Ray& ray) {
  if constexpr (Traits::geometry == Geometry::spheres_and_quads) {
    return closest_primitive<Traits>(scene, ray);
  } else {
    Hit nearest;
    if (Traits::geometry == Geometry::mixed && scene.primitives.count() > 0) {
      nearest = closest_primitive<Traits>(scene, ray);
    }
    Hit hit = closest_triangle<Traits::accel, Traits::has_instances>(scene.triangles, ray, 0.0f,
                                                                     nearest.t);
    if (hit.is_miss()) return nearest;
    hit.primitive += scene.primitives.count();
    return hit;
  }
}

/// True when something lies between the shadow ray's ends.
template <class Traits>
PT_HD bool intersect_shadow(const Scene& scene, const ShadowRay& shadow) {
  if constexpr (Traits::geometry == Geometry::spheres_and_quads) {
    return any_primitive<Traits>(scene, shadow.ray, shadow.distance);
  } else {
    if (Traits::geometry == Geometry::mixed && scene.primitives.count() > 0 &&
        any_primitive<Traits>(scene, shadow.ray, shadow.distance)) {
      return true;
    }
    return any_triangle<Traits::accel, Traits::has_instances>(scene.triangles, shadow.ray, 0.0f,
                                                              shadow.distance);
  }
}

}  // namespace pt
