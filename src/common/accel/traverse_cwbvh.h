// Traversal of compressed wide BVHs (Ylitie, Karras and Laine 2017), in one level or two. What is
// left to do is kept as groups: the children of a node that the ray meets, as bits of one word, and
// likewise the triangles of its leaves. Children are visited by (slot XOR ray octant).
#pragma once

#include "common/accel/nodes.h"
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
  std::uint32_t octant;  ///< bit `axis`: the direction is negative
  TriangleRay triangles;
};

PT_HD CwbvhRay make_cwbvh_ray(const Ray& ray) {
  CwbvhRay result;
  result.origin = ray.origin;
  result.octant = 0;
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

/// How much nearer the planes of a node's grid count where the ray enters, and farther where it
/// leaves, relative to the distance of the grid's origin: more than the rounding of this distance.
/// That of a plane's coordinate in the grid is in cwbvh_grid_tolerance, the triangle test's error
/// in the comparison.
inline constexpr float cwbvh_origin_tolerance = 8.0f * half_ulp;

/// The distances of a node's grid planes along one axis: q * step + near for the planes where the
/// ray enters, q * step + far where it leaves. `near` is no larger, and `far` no smaller, than the
/// exact distance of the plane that was encoded.
struct CwbvhAxis {
  float step, near, far;
};

PT_HD CwbvhAxis make_cwbvh_axis(float grid_origin, float grid_step, float origin, float inverse) {
  const float step = grid_step * inverse;
  const float base = (grid_origin - origin) * inverse;
  const float slack =
      fused_multiply_add(fabsf(base), cwbvh_origin_tolerance, fabsf(step) * cwbvh_grid_tolerance);
  return {step, base - slack, base + slack};
}

/// The slots of children that the ray meets.
PT_HD std::uint32_t intersect_cwbvh_node(const CwbvhNode& node, const CwbvhRay& ray, float t_min,
                                         float t_max) {
  CwbvhAxis axis[3];
  PT_UNROLL(3)
  for (int i = 0; i < 3; ++i) {
    axis[i] = make_cwbvh_axis(node.origin[i], node.step(i), ray.origin[i], ray.inverse[i]);
  }
  std::uint32_t hits = 0;
  PT_UNROLL(8)
  for (int s = 0; s < 8; ++s) {
    float near = t_min, far = t_max;
    PT_UNROLL(3)
    for (int i = 0; i < 3; ++i) {
      // Selected after loading: an address that depends on the ray would keep the node in memory.
      const std::uint8_t low = node.planes[i][2 * s], high = node.planes[i][2 * s + 1];
      const bool negative = ray.inverse[i] < 0.0f;
      const auto first = static_cast<float>(negative ? high : low);
      const auto second = static_cast<float>(negative ? low : high);
      near = max_number(fused_multiply_add(first, axis[i].step, axis[i].near), near);
      far = min_number(fused_multiply_add(second, axis[i].step, axis[i].far), far);
    }
    if (near <= far * (1.0f + slab_tolerance)) hits |= 1u << s;
  }
  return hits & node.used_mask();
}

/// Children of a node that are left to visit, and what finds them in memory. Inner ones: bits 0..7
/// are the slots, each XOR the ray's octant, so that the lowest is the nearest; bits 8..15 are the
/// node's inner_mask. Leaves: bits 0..7 are the slots, 8..15 leaf_mask, 16..23 pair_mask, 31 is
/// set.
struct CwbvhGroup {
  std::uint32_t base;
  std::uint32_t bits;

  PT_HD bool has_slots() const { return (bits & 0xffu) != 0; }
  PT_HD bool is_of_leaves() const { return (bits >> 31) != 0; }
};

/// Moves bit s to s XOR octant.
PT_HD std::uint32_t order_slots(std::uint32_t slots, std::uint32_t octant) {
  if ((octant & 1u) != 0) slots = (slots & 0x55u) << 1 | (slots & 0xaau) >> 1;
  if ((octant & 2u) != 0) slots = (slots & 0x33u) << 2 | (slots & 0xccu) >> 2;
  if ((octant & 4u) != 0) slots = (slots & 0x0fu) << 4 | (slots & 0xf0u) >> 4;
  return slots;
}

PT_HD CwbvhGroup root_group(std::uint32_t root, std::uint32_t octant) {
  return {root, 1u << octant | 1u << 8};  // as the child in slot 0
}
PT_HD CwbvhGroup inner_group(const CwbvhNode& node, std::uint32_t hits, std::uint32_t octant) {
  const std::uint32_t mask = node.inner_mask();
  return {node.child_base, order_slots(hits & mask, octant) | mask << 8};
}
PT_HD CwbvhGroup leaf_group(const CwbvhNode& node, std::uint32_t hits) {
  const std::uint32_t mask = node.leaf_mask();
  return {node.triangle_base, (hits & mask) | mask << 8 | node.pair_mask() << 16 | 1u << 31};
}

/// Takes the nearest child out of a group of inner ones; its index among the nodes.
PT_HD std::uint32_t take_child(CwbvhGroup& group, std::uint32_t octant) {
  const std::uint32_t nearest = group.bits & (0u - group.bits);
  group.bits ^= nearest;
  const std::uint32_t below = (1u << (count_bits(nearest - 1u) ^ octant)) - 1u;
  return group.base + static_cast<std::uint32_t>(count_bits(group.bits >> 8 & below));
}

/// The slots of one or two triangles, or of an instance.
struct CwbvhLeaf {
  std::uint32_t first, count;
};

/// Takes any leaf out of a group.
PT_HD CwbvhLeaf take_leaf(CwbvhGroup& group) {
  const std::uint32_t lowest = group.bits & (0u - group.bits);
  group.bits ^= lowest;
  const std::uint32_t below = (lowest - 1u) * 0x010100u;  // of both masks
  return {group.base + static_cast<std::uint32_t>(count_bits(group.bits & below)),
          (group.bits >> 16 & lowest) != 0 ? 2u : 1u};
}

/// How nodes and leaves are tested: one box, one triangle after the other.
struct CwbvhTests {
  PT_HD static CwbvhNode load(const CwbvhNode* node) { return load_wide(node); }
  PT_HD static std::uint32_t node(const CwbvhNode& node, const CwbvhRay& ray, float t_min,
                                  float t_max) {
    return intersect_cwbvh_node(node, ray, t_min, t_max);
  }

  /// Offers `leaf` to the query, and as many of `leaves`, which it takes out, as it likes to test
  /// with it; true: the traversal ends.
  template <class Query>
  PT_HD static bool offer(const TriangleTree& tree, const TriangleRay& ray, const CwbvhLeaf& leaf,
                          CwbvhGroup& /*leaves*/, Query& query) {
    return offer_slots(tree, ray, leaf.first, leaf.count, query);
  }
};

/// `instanced`: the tree may have instances.
template <bool instanced, class Tests, class Query>
PT_HD void traverse_cwbvh_by(const TriangleTree& tree, const Ray& ray, Query& query) {
  if (!is_traceable(ray) || tree.triangle_count == 0) return;
  constexpr int in_world = -1, only_level = -2;
  CwbvhGroup stack[instanced ? 2 * bvh_depth_max + 2 : bvh_depth_max];
  int depth = 0;
  // The stack's depth on entering the instance.
  int entered = instanced && tree.instance_count > 0 ? in_world : only_level;
  std::uint32_t instance = 0;
  InstanceVisit visit;
  CwbvhRay local = make_cwbvh_ray(ray);
  CwbvhGroup nodes = root_group(tree.root, local.octant), leaves{0, 0};
  while (true) {
    if (nodes.has_slots()) {
      lanes_of(ray).count(LanePoint::node);
      const std::uint32_t child = take_child(nodes, local.octant);
      if (nodes.has_slots()) stack[depth++] = nodes;
      const auto& node = Tests::load(&tree.cwbvh[child]);
      const bool inside = instanced && entered >= 0;
      const std::uint32_t hits = Tests::node(node, local, query.t_min(),
                                             inside ? visit.limit(query.t_max()) : query.t_max());
      nodes = inner_group(node, hits, local.octant);
      leaves = leaf_group(node, hits);
    }
    while (leaves.has_slots()) {
      const CwbvhLeaf leaf = take_leaf(leaves);
      if (instanced && entered == in_world) {
        visit = visit_instance_for(query, tree.instances[leaf.first], ray, make_slab_test_ray(ray));
        if (visit.is_empty) continue;
        if (leaves.has_slots()) stack[depth++] = leaves;
        if (nodes.has_slots()) stack[depth++] = nodes;
        entered = depth;
        instance = leaf.first;
        local = make_cwbvh_ray(visit.ray);
        nodes = root_group(tree.instances[instance].root, local.octant);
        leaves.bits = 0;
      } else if (instanced && entered >= 0) {
        lanes_of(ray).count(LanePoint::primitive);
        if (offer_slots(tree, local.triangles, leaf.first, leaf.count, visit, instance, query)) {
          return;
        }
      } else {
        lanes_of(ray).count(LanePoint::primitive);
        if (Tests::offer(tree, local.triangles, leaf, leaves, query)) return;
      }
    }
    if (nodes.has_slots()) continue;
    if (depth == 0) return;
    if (instanced && depth == entered) {
      entered = in_world;
      local = make_cwbvh_ray(ray);
    }
    const CwbvhGroup group = stack[--depth];
    (group.is_of_leaves() ? leaves : nodes) = group;
  }
}

template <bool instanced, class Query>
PT_HD void traverse_cwbvh(const TriangleTree& tree, const Ray& ray, Query& query) {
  traverse_cwbvh_by<instanced, CwbvhTests>(tree, ray, query);
}

}  // namespace pt
