// Tests every primitive: the paper's way, and the fastest one for a few dozen spheres. Tests every
// triangle of every instance: the reference of the other structures.
#pragma once

#include "common/accel/scan_halves.h"
#include "common/accel/triangle_query.h"
#include "common/geometry/primitives.h"

namespace pt {

inline constexpr int scan_group = 4;  ///< scanned spheres come in groups of this size
inline constexpr int scan_chunk = 32;

/// Bit 31 - j is set when the ray may meet spheres[first + j], 0 <= j < 32; `first` < `count`, a
/// multiple of scan_group. One pass without branches finds the candidates; the few that there are
/// come after, each thread turning to its own. Testing and resolving in one loop would make every
/// thread of a warp wait whenever any of them has a candidate, which for scattered rays is nearly
/// always. Where `first` is a constant and the spheres are a kernel's parameter, the tests need no
/// load: their operands come straight from the constant bank.
template <class First>
PT_HD std::uint32_t sphere_candidates(const Sphere* spheres, First first, std::uint32_t count,
                                      const ProjectedRay& ray) {
  std::uint32_t missed = 0;
  PT_UNROLL(8)
  for (std::uint32_t group = 0; group < scan_chunk; group += scan_group) {
    if (first + group < count) {
      PT_UNROLL(4)
      for (std::uint32_t j = 0; j < scan_group; ++j) {
        missed = shift_in_sign(missed, ray.nearness(load_wide(spheres + first + group + j)));
      }
    } else {
      missed = ~(~missed << scan_group);
    }
  }
  return ~missed;
}

/// Calls visit(distance, primitive) for the candidates until it returns true. `index_of(bit)`: the
/// sphere of a bit.
template <class IndexOf, class Visit>
PT_HD bool resolve_candidates(const Primitives& primitives, std::uint32_t candidates,
                              const Ray& ray, IndexOf&& index_of, Visit&& visit) {
  while (candidates != 0) {
    lanes_of(ray).count(LanePoint::primitive);
    const std::uint32_t bit = highest_bit(candidates);
    candidates &= ~(1u << bit);
    // A ray that is NaN has fillers for candidates, too, and meets nothing, whatever is tested.
    const std::uint32_t primitive = min_integer(index_of(bit), primitives.sphere_count - 1);
    if (visit(sphere_distance(load_wide(&primitives.spheres[primitive]), ray), primitive)) {
      return true;
    }
  }
  return false;
}

/// Calls chunk(first) for 0, size, ... below `count`, the first two of them constants, until it
/// returns true.
template <std::uint32_t size, class Chunk>
PT_HD bool for_each_chunk(std::uint32_t count, Chunk&& chunk) {
  if (count > 0 && chunk(std::integral_constant<std::uint32_t, 0>{})) return true;
  if (count > size && chunk(std::integral_constant<std::uint32_t, size>{})) return true;
  for (std::uint32_t first = 2 * size; first < count; first += size) {
    if (chunk(first)) return true;
  }
  return false;
}

/// Calls visit(distance, primitive) for every sphere that the ray may meet until it returns true.
template <class Visit>
PT_HD bool for_each_sphere(const Primitives& primitives, const Ray& ray, Visit&& visit) {
  const ProjectedRay projected(ray, primitives.scan_center);
  const std::uint32_t count = primitives.scan_count;
  return for_each_chunk<scan_chunk>(count, [&](auto first) {
    return resolve_candidates(
        primitives, sphere_candidates(primitives.scan, first, count, projected), ray,
        [&](std::uint32_t bit) { return first + 31 - bit; }, visit);
  });
}

/// As for_each_sphere, by candidates in half precision.
template <class Visit>
PT_HD bool for_each_half_sphere(const Primitives& primitives, const Ray& ray, Visit&& visit) {
  const ProjectedRay projected(ray, primitives.scan_center);
  const HalfProjectedRay halves(projected, primitives.half_scale);
  const std::uint32_t count = primitives.half_count;
  return for_each_chunk<half_groups>(count, [&](auto first) {
    const std::uint32_t groups = groups_of_chunk(first, count);
    return resolve_candidates(
        primitives, half_candidates(primitives.halves, first, count, halves), ray,
        [&](std::uint32_t bit) {
          return first * HalfSpheres::count + half_sphere_index(bit, groups);
        },
        visit);
  });
}

/// Calls visit(distance, primitive) for every intersection until it returns true.
template <class Visit>
PT_HD bool for_each_intersection(const Primitives& primitives, const Ray& ray, Visit&& visit) {
  if constexpr (has_half_pairs) {
    if (for_each_half_sphere(primitives, ray, visit)) return true;
  } else {
    if (for_each_sphere(primitives, ray, visit)) return true;
  }
  for (std::uint32_t i = 0; i < primitives.quad_count; ++i) {
    lanes_of(ray).count(LanePoint::primitive);
    if (visit(quad_distance(primitives.quads[i], ray), primitives.sphere_count + i)) return true;
  }
  return false;
}

PT_HD Hit closest_hit_brute(const Primitives& primitives, const Ray& ray) {
  Hit hit;
  for_each_intersection(primitives, ray, [&](float t, std::uint32_t primitive) {
    if (t > 0.0f && t < hit.t) {  // of equal distances the first is the lowest number's
      hit.t = t;
      hit.primitive = primitive;
    }
    return false;
  });
  return hit;
}

/// Whether anything lies on the ray nearer than `distance`.
PT_HD bool any_hit_brute(const Primitives& primitives, const Ray& ray, float distance) {
  return for_each_intersection(primitives, ray,
                               [&](float t, std::uint32_t) { return t > 0.0f && t < distance; });
}

/// `instanced`: the tree may have instances.
template <bool instanced, class Query>
PT_HD void traverse_triangles_brute(const TriangleTree& tree, const Ray& ray, Query& query) {
  if (!is_traceable(ray) || tree.triangle_count == 0) return;
  if constexpr (instanced) {
    const SlabTestRay world = make_slab_test_ray(ray);
    for (std::uint32_t i = 0; i < tree.instance_count; ++i) {
      const InstanceRecord& instance = tree.instances[i];
      const InstanceVisit visit = visit_instance_for(query, instance, ray, world);
      if (visit.is_empty) continue;
      lanes_of(ray).count(LanePoint::primitive);
      const TriangleRay local = make_triangle_ray(visit.ray.origin, visit.ray.direction);
      if (offer_slots(tree, local, instance.first_slot, instance.slot_count, visit, i, query)) {
        return;
      }
    }
  }
  if (!instanced || tree.instance_count == 0) {
    lanes_of(ray).count(LanePoint::primitive);
    const TriangleRay triangle_ray = make_triangle_ray(ray.origin, ray.direction);
    offer_slots(tree, triangle_ray, 0, tree.triangle_count, query);
  }
}

}  // namespace pt
