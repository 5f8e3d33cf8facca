// Step 2: what does the ray meet?
#pragma once

#include "common/accel/traverse_brute.h"
#include "common/accel/traverse_bvh2.h"
#include "common/scene/scene.h"

namespace pt {

/// A question to a light: does anything lie between, and if not, what arrives?
struct ShadowRay {
  Ray ray;
  float distance = 0.0f;
  Color radiance =
      Color(0.0f);  ///< added to the pixel's sample if the ray is free; black: no question
};

template <Accel accel>
PT_HD Hit intersect_closest(const Scene& scene, const Ray& ray) {
  if constexpr (accel == Accel::brute) {
    return closest_hit_brute(scene.primitives, ray);
  } else {
    return closest_hit_bvh2(scene.bvh_nodes, scene.primitives, ray);
  }
}

/// True when something lies between the shadow ray's ends.
template <Accel accel>
PT_HD bool intersect_shadow(const Scene& scene, const ShadowRay& shadow) {
  if constexpr (accel == Accel::brute) {
    return any_hit_brute(scene.primitives, shadow.ray, shadow.distance);
  } else {
    return any_hit_bvh2(scene.bvh_nodes, scene.primitives, shadow.ray, shadow.distance);
  }
}

}  // namespace pt
