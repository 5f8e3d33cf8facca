// Every kind of tree that the CPU builds.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "common/accel/build/build_triangle_tree.h"
#include "common/accel/traverse_triangles.h"

namespace pt {

struct TreeKind {
  const char* name;
  AccelKind accel;
  TreeBuilder builder;

  TriangleTreeData build(const std::vector<Mesh>& meshes,
                         const std::vector<Instance>& instances = {}) const {
    TreeOptions options;
    options.accel = accel, options.builder = builder;
    return build_triangle_tree(meshes, instances, options);
  }
};
inline void PrintTo(const TreeKind& kind, std::ostream* out) { *out << kind.name; }

inline const TreeKind tree_kinds[] = {
    {"bvh2_sah", AccelKind::bvh2, TreeBuilder::sah},
    {"bvh2_sbvh", AccelKind::bvh2, TreeBuilder::sbvh},
    {"cwbvh_sah", AccelKind::cwbvh, TreeBuilder::sah},
    {"cwbvh_sbvh", AccelKind::cwbvh, TreeBuilder::sbvh},
};
inline const TreeKind brute_kind = {"brute", AccelKind::brute, TreeBuilder::automatic};

template <bool instanced>
Hit closest_hit_of(const TriangleTreeData& data, const Ray& ray, float t_min, float t_max) {
  const TriangleTree tree = data.view();
  return !data.bvh2.empty()    ? closest_triangle<Accel::bvh2, instanced>(tree, ray, t_min, t_max)
         : !data.cwbvh.empty() ? closest_triangle<Accel::cwbvh, instanced>(tree, ray, t_min, t_max)
                               : closest_triangle<Accel::brute, instanced>(tree, ray, t_min, t_max);
}

template <bool instanced>
bool any_hit_of(const TriangleTreeData& data, const Ray& ray, float t_min, float t_max) {
  const TriangleTree tree = data.view();
  return !data.bvh2.empty()    ? any_triangle<Accel::bvh2, instanced>(tree, ray, t_min, t_max)
         : !data.cwbvh.empty() ? any_triangle<Accel::cwbvh, instanced>(tree, ray, t_min, t_max)
                               : any_triangle<Accel::brute, instanced>(tree, ray, t_min, t_max);
}

/// By a tree of one level or two.
inline Hit closest_hit(const TriangleTreeData& data, const Ray& ray, float t_min = 0.0f,
                       float t_max = infinite_distance) {
  return data.instances.empty() ? closest_hit_of<false>(data, ray, t_min, t_max)
                                : closest_hit_of<true>(data, ray, t_min, t_max);
}
inline bool any_hit(const TriangleTreeData& data, const Ray& ray, float t_min = 0.0f,
                    float t_max = infinite_distance) {
  return data.instances.empty() ? any_hit_of<false>(data, ray, t_min, t_max)
                                : any_hit_of<true>(data, ray, t_min, t_max);
}

}  // namespace pt
