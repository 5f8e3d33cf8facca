// Tests every primitive: the paper's way, and for a few dozen spheres the fastest one.
#pragma once

#include "common/geometry/primitives.h"

namespace pt {

/// Bit 31 - j is set when the ray's line meets sphere first[j], 0 <= j < count, 1 <= count <= 32.
/// One pass without branches finds the candidates; the few that there are come after, each thread
/// turning to its own. Testing and resolving in one loop would make every thread of a warp wait
/// whenever any of them has a candidate, which for scattered rays is nearly always.
PT_HD std::uint32_t sphere_candidates(const Sphere* first, int count, const Ray& ray) {
  std::uint32_t missed = 0;
  PT_UNROLL(8)
  for (int j = 0; j < count; ++j) {
    missed = shift_in_sign(missed, sphere_discriminant(load_wide(first + j), ray));
  }
  return ~missed << (32 - count);
}

/// Calls visit(distance, primitive) for every candidate until it returns true.
template <class Visit>
PT_HD bool for_each_intersection(const Primitives& primitives, const Ray& ray, Visit&& visit) {
  for (std::uint32_t first = 0; first < primitives.sphere_count; first += 32) {
    const std::uint32_t rest = primitives.sphere_count - first;
    std::uint32_t candidates =
        sphere_candidates(primitives.spheres + first, static_cast<int>(rest < 32 ? rest : 32), ray);
    while (candidates != 0) {
      const int j = count_leading_zeros(candidates);
      candidates &= ~(0x80000000u >> j);
      if (visit(sphere_distance(load_wide(&primitives.spheres[first + j]), ray), first + j))
        return true;
    }
  }
  for (std::uint32_t i = 0; i < primitives.quad_count; ++i) {
    if (visit(quad_distance(primitives.quads[i], ray), primitives.sphere_count + i)) return true;
  }
  return false;
}

PT_HD Hit closest_hit_brute(const Primitives& primitives, const Ray& ray) {
  Hit hit;
  for_each_intersection(primitives, ray, [&](float t, std::uint32_t primitive) {
    keep_nearer(hit, t, primitive);
    return false;
  });
  return hit;
}

/// Whether anything lies on the ray nearer than `distance`.
PT_HD bool any_hit_brute(const Primitives& primitives, const Ray& ray, float distance) {
  return for_each_intersection(primitives, ray,
                               [&](float t, std::uint32_t) { return t > 0.0f && t < distance; });
}

}  // namespace pt
