// Tests every triangle, of every instance: the reference of the other structures.
#pragma once

#include "common/accel/triangle_query.h"

namespace pt {

/// `instanced`: the tree may have instances.
template <bool instanced, class Query>
PT_HD void traverse_triangles_brute(const TriangleTree& tree, const Ray& ray, Query& query) {
  if (!is_traceable(ray) || tree.triangle_count == 0) return;
  if constexpr (instanced) {
    for (std::uint32_t i = 0; i < tree.instance_count; ++i) {
      const InstanceRecord& instance = tree.instances[i];
      const Ray local = object_ray(instance, ray);
      if (!is_traceable(local)) continue;
      const TriangleRay triangle_ray = make_triangle_ray(local.origin, local.direction);
      if (offer_slots(tree, triangle_ray, instance.first_slot, instance.slot_count, i, query))
        return;
    }
  }
  if (!instanced || tree.instance_count == 0) {
    const TriangleRay triangle_ray = make_triangle_ray(ray.origin, ray.direction);
    offer_slots(tree, triangle_ray, 0, tree.triangle_count, 0, query);
  }
}

/// The closest hit with t_min < t < t_max.
template <bool instanced>
PT_HD Hit closest_triangle_brute(const TriangleTree& tree, const Ray& ray, float t_min,
                                 float t_max) {
  ClosestTriangle query(t_min, t_max);
  traverse_triangles_brute<instanced>(tree, ray, query);
  return query.result();
}

/// Whether there is a hit with t_min < t < t_max.
template <bool instanced>
PT_HD bool any_triangle_brute(const TriangleTree& tree, const Ray& ray, float t_min, float t_max) {
  AnyTriangle query(t_min, t_max);
  traverse_triangles_brute<instanced>(tree, ray, query);
  return query.result();
}

}  // namespace pt
