// Traversal of binary BVHs: nearest child first, a short stack (Aila and Laine 2009, while-while).
#pragma once

#include "common/accel/nodes.h"
#include "common/accel/slab_test.h"
#include "common/accel/triangle_query.h"
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
  const float x0 = fused_multiply_add(xy.x, ray.inverse.x, ray.offset.x);
  const float x1 = fused_multiply_add(xy.y, ray.inverse.x, ray.offset.x);
  const float y0 = fused_multiply_add(xy.z, ray.inverse.y, ray.offset.y);
  const float y1 = fused_multiply_add(xy.w, ray.inverse.y, ray.offset.y);
  const float z0 = fused_multiply_add(min_z, ray.inverse.z, ray.offset.z);
  const float z1 = fused_multiply_add(max_z, ray.inverse.z, ray.offset.z);
  return {fmaxf(fmaxf(fminf(x0, x1), fminf(y0, y1)), fmaxf(fminf(z0, z1), 0.0f)),
          fminf(fminf(fmaxf(x0, x1), fmaxf(y0, y1)), fminf(fmaxf(z0, z1), t_max))};
}

/// Visits the leaves' primitives near to far: visit(distance, primitive, t_max) may lower t_max and
/// ends the traversal by returning true. `primitives`: Primitives, or MovingPrimitives.
template <class All, class Visit>
PT_HD bool traverse_bvh2(const Bvh2Node* nodes, const All& primitives, const Ray& ray, float t_max,
                         Visit&& visit) {
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

template <class All>
PT_HD Hit closest_hit_bvh2(const Bvh2Node* nodes, const All& primitives, const Ray& ray) {
  Hit hit;
  traverse_bvh2(nodes, primitives, ray, hit.t, [&](float t, std::uint32_t primitive, float& t_max) {
    keep_nearer(hit, t, primitive);
    t_max = hit.t;
    return false;
  });
  return hit;
}

/// Whether anything lies on the ray nearer than `distance`.
template <class All>
PT_HD bool any_hit_bvh2(const Bvh2Node* nodes, const All& primitives, const Ray& ray,
                        float distance) {
  return traverse_bvh2(nodes, primitives, ray, distance,
                       [&](float t, std::uint32_t, float&) { return t > 0.0f && t < distance; });
}

// Trees of triangles, in one level or two. Both levels share a stack: the ray is back in the world
// when the stack is as low as it was on entering the instance.

/// A ray as a tree needs it.
struct Bvh2Ray {
  SlabTestRay slabs;
  TriangleRay triangles;
};

PT_HD Bvh2Ray make_bvh2_ray(const Ray& ray) {
  return {make_slab_test_ray(ray), make_triangle_ray(ray.origin, ray.direction)};
}

/// What to visit next below a node: `children` of them, the nearer one first.
struct Bvh2Step {
  int children;
  std::uint32_t first, second;
};

PT_HD_IN_LOOP Bvh2Step step_bvh2(const Bvh2Node& node, const SlabTestRay& ray, float t_min,
                                 float t_max) {
  const SlabInterval a = intersect_box(ray, {node.xy[0].x, node.xy[0].z, node.z.x},
                                       {node.xy[0].y, node.xy[0].w, node.z.y}, t_min, t_max);
  const SlabInterval b = intersect_box(ray, {node.xy[1].x, node.xy[1].z, node.z.z},
                                       {node.xy[1].y, node.xy[1].w, node.z.w}, t_min, t_max);
  const bool a_first = a.is_hit() && !(b.is_hit() && b.near < a.near);
  return {static_cast<int>(a.is_hit()) + static_cast<int>(b.is_hit()),
          a_first ? node.child[0] : node.child[1], a_first ? node.child[1] : node.child[0]};
}

/// `instanced`: the tree may have instances.
template <bool instanced, class Query>
PT_HD void traverse_triangles_bvh2(const TriangleTree& tree, const Ray& ray, Query& query) {
  if (!is_traceable(ray) || tree.triangle_count == 0) return;
  constexpr int in_world = -1, only_level = -2;
  std::uint32_t stack[instanced ? 2 * bvh_depth_max + 1 : bvh_depth_max];
  int depth = 0;
  // The stack's depth on entering the instance.
  int entered = instanced && tree.instance_count > 0 ? in_world : only_level;
  std::uint32_t instance = 0;
  InstanceVisit visit;
  Bvh2Ray local = make_bvh2_ray(ray);
  std::uint32_t current = tree.root;
  // One way round the loop and one way out, whatever was done: threads of a warp that step down,
  // that test a leaf and that take a node from the stack meet again after each turn. Otherwise the
  // compiler makes an inner loop of the steps, in which all others wait: a quarter slower for
  // incoherent rays.
  constexpr std::uint32_t none = 0x7fffffffu, done = 0x7ffffffeu;  // nodes that no tree has
  while (current != done) {
    std::uint32_t next = none;
    if (!is_leaf(current)) {
      lanes_of(ray).count(LanePoint::node);
      const Bvh2Node node = node_for(query, tree, current);
      const bool inside = instanced && entered >= 0;
      const Bvh2Step step = step_bvh2(node, local.slabs, query.t_min(),
                                      inside ? visit.limit(query.t_max()) : query.t_max());
      if (step.children > 1) stack[depth++] = step.second;
      if (step.children > 0) next = step.first;
    } else if (instanced && entered == in_world) {
      instance = leaf_first(current);
      if (leaf_count(current) > 1) {
        stack[depth++] = make_leaf(instance + 1, leaf_count(current) - 1);
      }
      visit = visit_instance_for(query, tree.instances[instance], ray, local.slabs);
      if (!visit.is_empty) {
        entered = depth;
        local = make_bvh2_ray(visit.ray);
        next = tree.instances[instance].root;
      }
    } else if (instanced && entered >= 0) {
      lanes_of(ray).count(LanePoint::primitive);
      if (offer_slots(tree, local.triangles, leaf_first(current), leaf_count(current), visit,
                      instance, query)) {
        next = done;
      }
    } else {
      lanes_of(ray).count(LanePoint::primitive);
      if (offer_slots(tree, local.triangles, leaf_first(current), leaf_count(current), query)) {
        next = done;
      }
    }
    if (next == none) {
      if (instanced && depth == entered && depth > 0) {
        entered = in_world;
        local = make_bvh2_ray(ray);
      }
      next = depth > 0 ? stack[--depth] : done;
    }
    current = next;
  }
}

}  // namespace pt
