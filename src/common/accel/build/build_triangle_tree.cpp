#include "common/accel/build/build_triangle_tree.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <numeric>

#include "common/accel/build/append_nodes.h"
#include "common/accel/build/build_sah.h"
#include "common/accel/build/build_sbvh.h"
#include "common/accel/build/check_builder.h"
#include "common/accel/build/collapse_cwbvh.h"
#include "common/accel/build/instance_tree.h"
#include "common/accel/build/merge_leaves.h"
#include "common/accel/build/mesh_triangles.h"
#include "common/render/option_names.h"

namespace pt {

namespace {

BinaryTree build_binary(const MeshTriangles& triangles, const TreeOptions& options) {
  if (options.builder == TreeBuilder::sbvh) {
    return build_sbvh(
        triangles.count(), [&](std::uint32_t i) { return triangles[i]; }, options.sbvh);
  }
  return build_sah(triangles.count(), [&](std::uint32_t i) { return triangles.bounds(i); });
}

/// Appends the group's tree, and its triangles in the order of the tree's slots.
void add_group(TriangleTreeData& tree, std::span<const Mesh> meshes, std::uint32_t number,
               const TreeOptions& options) {
  const MeshTriangles triangles(meshes, number);
  if (triangles.count() == 0) return;
  GroupTree group;
  group.group = number;
  group.first_slot = static_cast<std::uint32_t>(tree.triangles.size());
  std::vector<std::uint32_t> order;
  if (options.accel == AccelKind::bvh2) {
    BinaryTree binary = build_binary(triangles, options);
    group.bounds = binary.bounds;
    Bvh2 bvh = merge_leaves(std::move(binary), options.bvh2_costs);
    order = std::move(bvh.order);
    group.node_count = static_cast<std::uint32_t>(bvh.nodes.size());
    group.root = append_nodes(tree.bvh2, std::move(bvh.nodes), group.first_slot);
  } else if (options.accel == AccelKind::cwbvh) {
    const BinaryTree binary = build_binary(triangles, options);
    group.bounds = binary.bounds;
    Cwbvh bvh = collapse_cwbvh(binary, options.cwbvh_costs);
    order = std::move(bvh.order);
    group.node_count = static_cast<std::uint32_t>(bvh.nodes.size());
    group.root = append_nodes(tree.cwbvh, std::move(bvh.nodes), group.first_slot);
  } else {
    order.resize(triangles.count());
    std::iota(order.begin(), order.end(), 0u);
    for (const std::uint32_t i : order) group.bounds.grow(triangles.bounds(i));
  }
  group.first_node = group.root;
  group.slot_count = static_cast<std::uint32_t>(order.size());
  tree.triangles.resize(tree.triangles.size() + order.size());
  tbb::parallel_for(0u, group.slot_count, [&](std::uint32_t i) {
    tree.triangles[group.first_slot + i] = triangles[order[i]];
  });
  tree.groups.push_back(group);
}

}  // namespace

void check_geometry(std::span<const Mesh> meshes, std::span<const Instance> instances) {
  MeshTriangles(meshes).check();
  check_instances(instances);
}

TriangleTreeData build_triangle_tree(std::span<const Mesh> meshes,
                                     std::span<const Instance> instances,
                                     const TreeOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  TreeOptions chosen = options;
  if (chosen.accel == AccelKind::automatic) chosen.accel = AccelKind::cwbvh;
  check_builder(chosen.builder, chosen.accel, false);
  check_geometry(meshes, instances);
  TriangleTreeData tree;
  for (const std::uint32_t group : groups_in_use(instances)) {
    add_group(tree, meshes, group, chosen);
  }
  if (!instances.empty()) {
    add_instance_tree(tree, instances, chosen.accel);
  } else if (!tree.groups.empty()) {
    tree.root = tree.groups.front().root;
  }
  const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - begin;
  tree.build_ms = time.count();
  const bool sah = chosen.builder == TreeBuilder::automatic;
  if (chosen.accel != AccelKind::brute) {
    tree.builder = to_string(sah ? TreeBuilder::sah : chosen.builder);
  }
  return tree;
}

}  // namespace pt
