// Traversal of triangles in the structure that a type names.
#pragma once

#include "common/accel/traverse_brute.h"
#include "common/accel/traverse_bvh2.h"
#include "common/accel/traverse_cwbvh.h"
#include "common/choices/accel.h"

namespace pt {

// On the CPU alone (embree_tree.cpp).
Hit closest_triangle_embree(const EmbreeTree& tree, const Ray& ray, float t_min, float t_max);
bool any_triangle_embree(const EmbreeTree& tree, const Ray& ray, float t_min, float t_max);

// On the CPU alone, where has_avx2() (trace_avx2.cpp).
bool has_avx2();
template <class Query>
void traverse_triangles_avx2(const TriangleTree& tree, const Ray& ray, Query& query);

/// By threads that follow a ray each; not for those that have traversals of their own.
template <Accel accel, bool instanced, class Query>
PT_HD void traverse_triangles(const TriangleTree& tree, const Ray& ray, Query& query) {
  static_assert(accel != Accel::embree);
  if constexpr (accel == Accel::brute) traverse_triangles_brute<instanced>(tree, ray, query);
  if constexpr (accel == Accel::bvh2) traverse_triangles_bvh2<instanced>(tree, ray, query);
  if constexpr (accel == Accel::cwbvh) traverse_cwbvh<instanced>(tree, ray, query);
  if constexpr (accel == Accel::cwbvh_avx2) traverse_triangles_avx2(tree, ray, query);
}

/// The closest hit with t_min < t < t_max; t_min >= 0. Hit::primitive is the triangle's slot.
template <Accel accel, bool instanced>
PT_HD Hit closest_triangle(const TriangleTree& tree, const Ray& ray, float t_min, float t_max) {
  if constexpr (accel == Accel::embree) {
    return closest_triangle_embree(*tree.embree, ray, t_min, t_max);
  } else {
    ClosestTriangle query(t_min, t_max);
    traverse_triangles<accel, instanced>(tree, ray, query);
    return query.result();
  }
}

/// Whether there is a hit with t_min < t < t_max; t_min >= 0.
template <Accel accel, bool instanced>
PT_HD bool any_triangle(const TriangleTree& tree, const Ray& ray, float t_min, float t_max) {
  if constexpr (accel == Accel::embree) {
    return any_triangle_embree(*tree.embree, ray, t_min, t_max);
  } else {
    AnyTriangle query(t_min, t_max);
    traverse_triangles<accel, instanced>(tree, ray, query);
    return query.result();
  }
}

}  // namespace pt
