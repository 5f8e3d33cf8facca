// Traversal of compressed wide BVHs (Ylitie, Karras and Laine 2017), in one level or two. What is
// left to do is kept as groups: the children of a node that the ray meets, as bits of one word, and
// likewise the triangles of its leaves. Children are visited by (slot XOR ray octant).
#pragma once

#include "common/accel/slab_test.h"
#include "common/accel/triangle_query.h"

namespace pt {

/// Direction components count as no smaller than this: on the nodes' grids infinities would come to
/// NaN, and every box would be passed.
inline constexpr float cwbvh_least_direction = 8.2718061e-25f;  // 2^-80

/// A ray as the wide tree needs it.
struct CwbvhRay {
  Vec3 origin;
  Vec3 inverse;
  std::uint32_t octant;  ///< 7 less bit `axis` for a negative direction
  TriangleRay triangles;
};

PT_HD CwbvhRay make_cwbvh_ray(const Ray& ray) {
  CwbvhRay result;
  result.origin = ray.origin;
  result.octant = 7;
  result.triangles = make_triangle_ray(ray.origin, ray.direction);
  PT_UNROLL(3)
  for (int axis = 0; axis < 3; ++axis) {
    const float d = ray.direction[axis];
    const float safe = copysignf(fmaxf(fabsf(d), cwbvh_least_direction), d);
    result.inverse[axis] = approximate_inverse(safe);
    if (result.inverse[axis] < 0.0f) result.octant ^= 1u << axis;
  }
  return result;
}

/// The distances of a node's grid planes along one axis: q * step + near for the planes where the
/// ray enters, q * step + far where it leaves. `near` and `far` are apart by more than the rounding
/// errors, which are relative to the distance of the grid's origin and to the size of the grid.
struct CwbvhAxis {
  float step, near, far;
};

PT_HD CwbvhAxis make_cwbvh_axis(float grid_origin, std::uint32_t exponent, float origin,
                                float inverse) {
  constexpr float grid_tolerance = 256.0f * slab_tolerance;
  const float step = bits_to_float(exponent << 23) * inverse;
  const float base = (grid_origin - origin) * inverse;
  const float slack = fused_multiply_add(fabsf(base), slab_tolerance, fabsf(step) * grid_tolerance);
  return {step, base - slack, base + slack};
}

/// The children that the ray meets: bits 24..31 the inner ones at 24 + (slot ^ octant), bits 0..23
/// the triangles of leaves.
PT_HD std::uint32_t intersect_cwbvh_node(const CwbvhNode& node, const CwbvhRay& ray, float t_min,
                                         float t_max) {
  CwbvhAxis axis[3];
  PT_UNROLL(3)
  for (int i = 0; i < 3; ++i) {
    axis[i] = make_cwbvh_axis(node.origin[i], node.exponent[i], ray.origin[i], ray.inverse[i]);
  }
  const bool x = ray.inverse.x < 0.0f, y = ray.inverse.y < 0.0f, z = ray.inverse.z < 0.0f;
  std::uint32_t hits = 0;
  PT_UNROLL(8)
  for (int s = 0; s < 8; ++s) {
    const auto distance = [&](int i, bool high, const std::uint8_t* low_q,
                              const std::uint8_t* high_q, float base) {
      const auto q = static_cast<float>(high ? high_q[s] : low_q[s]);
      return fused_multiply_add(q, axis[i].step, base);
    };
    const float near_x = distance(0, x, node.low_x, node.high_x, axis[0].near);
    const float near_y = distance(1, y, node.low_y, node.high_y, axis[1].near);
    const float near_z = distance(2, z, node.low_z, node.high_z, axis[2].near);
    const float far_x = distance(0, !x, node.low_x, node.high_x, axis[0].far);
    const float far_y = distance(1, !y, node.low_y, node.high_y, axis[1].far);
    const float far_z = distance(2, !z, node.low_z, node.high_z, axis[2].far);
    const float near = max_number(near_x, max_number(near_y, max_number(near_z, t_min)));
    const float far = min_number(far_x, min_number(far_y, min_number(far_z, t_max)));
    if (near <= far) {
      const std::uint32_t meta = node.meta[s];
      const std::uint32_t place = meta & 31u;
      hits |= (meta >> 5) << (place >= 24u ? place ^ ray.octant : place);
    }
  }
  return hits;
}

/// What is left of a node: bits of intersect_cwbvh_node (of its upper 8 or its lower 24) and where
/// they point to.
struct CwbvhGroup {
  std::uint32_t base;
  std::uint32_t bits;  ///< of a group of inner children, bits 0..7 are the node's inner_mask
};

PT_HD bool has_children(const CwbvhGroup& group) { return group.bits > 0x00ffffffu; }

/// Takes the nearest child out of a group; its place among the nodes.
PT_HD std::uint32_t take_child(CwbvhGroup& group, std::uint32_t octant) {
  const int bit = 31 - count_leading_zeros(group.bits);
  group.bits &= ~(1u << bit);
  const std::uint32_t slot = static_cast<std::uint32_t>(bit - 24) ^ octant;
  return group.base + static_cast<std::uint32_t>(count_bits(group.bits & ~(~0u << slot)));
}

/// Takes a triangle (or instance) out of a group; its slot.
PT_HD std::uint32_t take_triangle(CwbvhGroup& group) {
  const int bit = 31 - count_leading_zeros(group.bits);
  group.bits &= ~(1u << bit);
  return group.base + static_cast<std::uint32_t>(bit);
}

/// `instanced`: the tree may have instances.
template <bool instanced, class Query>
PT_HD void traverse_cwbvh(const TriangleTree& tree, const Ray& ray, Query& query) {
  if (!is_traceable(ray) || tree.triangle_count == 0) return;
  constexpr int in_world = -1, only_level = -2;
  CwbvhGroup stack[instanced ? 2 * bvh_depth_max + 2 : bvh_depth_max];
  int depth = 0;
  // The stack's depth on entering the instance.
  int entered = instanced && tree.instance_count > 0 ? in_world : only_level;
  std::uint32_t instance = 0;
  CwbvhRay local = make_cwbvh_ray(ray);
  CwbvhGroup nodes{tree.root, 0x80000000u};  // the only child: its slot does not matter
  CwbvhGroup triangles{0, 0};
  while (true) {
    if (has_children(nodes)) {
      const std::uint32_t child = take_child(nodes, local.octant);
      if (has_children(nodes)) stack[depth++] = nodes;
      const CwbvhNode node = load_wide(&tree.cwbvh[child]);
      const std::uint32_t hits = intersect_cwbvh_node(node, local, query.t_min(), query.t_max());
      nodes = {node.child_base, (hits & 0xff000000u) | node.inner_mask};
      triangles = {node.triangle_base, hits & 0x00ffffffu};
    }
    while (triangles.bits != 0) {
      const std::uint32_t slot = take_triangle(triangles);
      if (instanced && entered == in_world) {
        const Ray inner = object_ray(tree.instances[slot], ray);
        if (!is_traceable(inner)) continue;
        if (triangles.bits != 0) stack[depth++] = triangles;
        if (has_children(nodes)) stack[depth++] = nodes;
        entered = depth;
        instance = slot;
        local = make_cwbvh_ray(inner);
        nodes = {tree.instances[slot].root, 0x80000000u};
        triangles.bits = 0;
      } else if (offer_slots(tree, local.triangles, slot, 1, instance, query)) {
        return;
      }
    }
    if (has_children(nodes)) continue;
    if (depth == 0) return;
    if (instanced && depth == entered) {
      entered = in_world;
      local = make_cwbvh_ray(ray);
    }
    const CwbvhGroup group = stack[--depth];
    (has_children(group) ? nodes : triangles) = group;
  }
}

/// The closest hit with t_min < t < t_max; t_min >= 0.
template <bool instanced>
PT_HD Hit closest_triangle_cwbvh(const TriangleTree& tree, const Ray& ray, float t_min,
                                 float t_max) {
  ClosestTriangle query(t_min, t_max);
  traverse_cwbvh<instanced>(tree, ray, query);
  return query.result();
}

/// Whether there is a hit with t_min < t < t_max; t_min >= 0.
template <bool instanced>
PT_HD bool any_triangle_cwbvh(const TriangleTree& tree, const Ray& ray, float t_min, float t_max) {
  AnyTriangle query(t_min, t_max);
  traverse_cwbvh<instanced>(tree, ray, query);
  return query.result();
}

}  // namespace pt
