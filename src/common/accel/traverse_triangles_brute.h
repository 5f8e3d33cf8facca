// Tests every triangle, of every instance: the reference of the other structures.
#pragma once

#include "common/accel/triangle_query.h"

namespace pt {

/// `instanced`: the tree may have instances.
template <bool instanced, class Query>
PT_HD void traverse_triangles_brute(const TriangleTree& tree, const Ray& ray, Query& query) {
  if (!is_traceable(ray) || tree.triangle_count == 0) return;
  if constexpr (instanced) {
    const SlabTestRay world = make_slab_test_ray(ray);
    for (std::uint32_t i = 0; i < tree.instance_count; ++i) {
      const InstanceRecord& instance = tree.instances[i];
      const InstanceVisit visit =
          visit_instance(instance, ray, world, query.t_min(), query.t_max());
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
