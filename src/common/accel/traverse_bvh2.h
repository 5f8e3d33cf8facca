// Traversal of the binary BVH: nearest child first, a short stack (Aila and Laine 2009,
// while-while).
#pragma once

#include "common/accel/nodes.h"
#include "common/geometry/primitives.h"

namespace pt {

/// A ray prepared for slab tests: t = plane * inverse + offset. The rounding of `offset` moves a
/// plane by a few ulps of the origin's size; the builder widens all boxes by more than that.
struct SlabRay {
  Vec3 inverse;
  Vec3 offset;
};

PT_HD SlabRay make_slab_ray(const Ray& ray) {
  SlabRay slab;
  for (int axis = 0; axis < 3; ++axis) {
    // A zero component would make 0 * infinity.
    const float d = ray.direction[axis];
    const float safe = fabsf(d) < 1e-18f ? copysignf(1e-18f, d) : d;
    slab.inverse[axis] = 1.0f / safe;
    slab.offset[axis] = -ray.origin[axis] * slab.inverse[axis];
  }
  return slab;
}

struct SlabHit {
  float near, far;
  PT_HD bool hit() const { return near <= far; }
};

PT_HD SlabHit intersect_slabs(const SlabRay& ray, const Vec4& xy, float min_z, float max_z,
                              float t_max) {
  const float x0 = xy.x * ray.inverse.x + ray.offset.x;
  const float x1 = xy.y * ray.inverse.x + ray.offset.x;
  const float y0 = xy.z * ray.inverse.y + ray.offset.y;
  const float y1 = xy.w * ray.inverse.y + ray.offset.y;
  const float z0 = min_z * ray.inverse.z + ray.offset.z;
  const float z1 = max_z * ray.inverse.z + ray.offset.z;
  return {fmaxf(fmaxf(fminf(x0, x1), fminf(y0, y1)), fmaxf(fminf(z0, z1), 0.0f)),
          fminf(fminf(fmaxf(x0, x1), fmaxf(y0, y1)), fminf(fmaxf(z0, z1), t_max))};
}

/// Visits the leaves' primitives near to far: visit(distance, primitive, t_max) may lower t_max and
/// ends the traversal by returning true.
template <class Visit>
PT_HD bool traverse_bvh2(const Bvh2Node* nodes, const Primitives& primitives, const Ray& ray,
                         float t_max, Visit&& visit) {
  constexpr std::uint32_t done = 0x7fffffffu;  // an inner node's number that no tree has
  const SlabRay slab = make_slab_ray(ray);
  std::uint32_t stack[bvh_depth_max];
  int depth = 0;
  std::uint32_t current = 0;
  while (current != done) {
    while (!is_leaf(current) && current != done) {
      lanes_of(ray).count(LanePoint::node);
      const Bvh2Node node = load_wide(&nodes[current]);
      const SlabHit a = intersect_slabs(slab, node.xy[0], node.z.x, node.z.y, t_max);
      const SlabHit b = intersect_slabs(slab, node.xy[1], node.z.z, node.z.w, t_max);
      if (a.hit() && b.hit()) {
        const bool a_first = a.near <= b.near;
        current = a_first ? node.child[0] : node.child[1];
        stack[depth++] = a_first ? node.child[1] : node.child[0];
      } else if (a.hit() || b.hit()) {
        current = a.hit() ? node.child[0] : node.child[1];
      } else {
        current = depth > 0 ? stack[--depth] : done;
      }
    }
    if (current == done) break;
    const std::uint32_t first = leaf_first(current);
    const std::uint32_t end = first + leaf_count(current);
    for (std::uint32_t i = first; i < end; ++i) {
      lanes_of(ray).count(LanePoint::primitive);
      if (visit(primitive_distance(primitives, i, ray), i, t_max)) return true;
    }
    current = depth > 0 ? stack[--depth] : done;
  }
  return false;
}

PT_HD Hit closest_hit_bvh2(const Bvh2Node* nodes, const Primitives& primitives, const Ray& ray) {
  Hit hit;
  traverse_bvh2(nodes, primitives, ray, hit.t, [&](float t, std::uint32_t primitive, float& t_max) {
    keep_nearer(hit, t, primitive);
    t_max = hit.t;
    return false;
  });
  return hit;
}

/// Whether anything lies on the ray nearer than `distance`.
PT_HD bool any_hit_bvh2(const Bvh2Node* nodes, const Primitives& primitives, const Ray& ray,
                        float distance) {
  return traverse_bvh2(nodes, primitives, ray, distance,
                       [&](float t, std::uint32_t, float&) { return t > 0.0f && t < distance; });
}

}  // namespace pt
