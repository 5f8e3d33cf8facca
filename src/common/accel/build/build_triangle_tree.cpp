#include "common/accel/build/build_triangle_tree.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <numeric>
#include <set>

#include "common/accel/build/append_nodes.h"
#include "common/accel/build/build_sah.h"
#include "common/accel/build/build_sbvh.h"
#include "common/accel/build/check_builder.h"
#include "common/accel/build/collapse_cwbvh.h"
#include "common/accel/build/instance_tree.h"
#include "common/accel/build/merge_leaves.h"
#include "common/accel/build/mesh_triangles.h"
#include "common/accel/build/overlap_share.h"
#include "common/accel/build/reinsert_nodes.h"

namespace pt {

namespace {

/// The tree of one group: its root and its slots come first.
struct BuiltGroup {
  Bounds bounds;
  std::vector<Bvh2Node> bvh2;  ///< one of the two, or none where every triangle is tested
  std::vector<CwbvhNode> cwbvh;
  std::vector<std::uint32_t> order;  ///< slot -> the group's triangle
  std::string builder;               ///< by name; empty: no tree

  double sah_cost(const TreeOptions& options) const {
    return bvh2.empty() ? measure_tree(std::span(cwbvh), 0).sah_cost(options.cwbvh_costs.triangle)
                        : measure_tree(std::span(bvh2), 0).sah_cost(options.bvh2_costs.triangle);
  }
};

BuiltGroup finish_tree(BinaryTree&& binary, const char* builder, const TreeOptions& options) {
  BuiltGroup built;
  built.bounds = binary.bounds;
  built.builder = builder;
  if (options.accel == AccelKind::bvh2) {
    Bvh2 tree = merge_leaves(std::move(binary), options.bvh2_costs);
    built.bvh2 = std::move(tree.nodes), built.order = std::move(tree.order);
  } else {
    Cwbvh tree = collapse_cwbvh(binary, options.cwbvh_costs);
    built.cwbvh = std::move(tree.nodes), built.order = std::move(tree.order);
  }
  return built;
}

BinaryTree build_whole(const MeshTriangles& triangles) {
  return build_sah(triangles.count(), [&](std::uint32_t i) { return triangles.bounds(i); });
}

BuiltGroup build_split(const MeshTriangles& triangles, const TreeOptions& options) {
  BinaryTree binary = build_sbvh(
      triangles.count(), [&](std::uint32_t i) { return triangles[i]; }, options.sbvh);
  return finish_tree(std::move(binary), "sbvh", options);
}

// When the automatic builder tries spatial splits and takes them, measured on some fifteen scenes
// (docs/design/tracing.md).
constexpr double split_share = 1.5;        // overlap_share() of a tree worth the try
constexpr double large_split_share = 2.0;  // the same from large_count triangles on
constexpr std::uint32_t large_count = 1u << 21;
constexpr double split_gain = 0.92;  // of costs, at most, to be taken

/// The tree by `sah`, improved by reinsertion if it can be, or a much cheaper one by `sbvh`.
BuiltGroup build_cheapest(const MeshTriangles& triangles, const TreeOptions& options) {
  BinaryTree binary = build_whole(triangles);
  std::optional<BinaryTree> improved = reinsert_nodes(binary);
  const char* const builder = improved ? "sah-reinsert" : "sah";
  if (improved) binary = std::move(*improved);
  const bool is_large = triangles.count() >= large_count;
  const bool tries = overlap_share(binary) >= (is_large ? large_split_share : split_share);
  BuiltGroup whole = finish_tree(std::move(binary), builder, options);
  if (!tries) return whole;
  BuiltGroup split = build_split(triangles, options);
  const bool pays = split.sah_cost(options) <= split_gain * whole.sah_cost(options);
  return pays ? split : whole;
}

BuiltGroup build_tree(const MeshTriangles& triangles, const TreeOptions& options) {
  if (options.builder == TreeBuilder::automatic) return build_cheapest(triangles, options);
  if (options.builder == TreeBuilder::sbvh) return build_split(triangles, options);
  return finish_tree(build_whole(triangles), "sah", options);
}

BuiltGroup list_triangles(const MeshTriangles& triangles) {
  BuiltGroup list;
  list.order.resize(triangles.count());
  std::iota(list.order.begin(), list.order.end(), 0u);
  for (const std::uint32_t i : list.order) list.bounds.grow(triangles.bounds(i));
  return list;
}

/// Appends the group's tree, and its triangles in the order of the tree's slots. Returns who built
/// it.
std::string add_group(TriangleTreeData& tree, const MeshTriangles& triangles,
                      std::uint32_t group_index, const TreeOptions& options) {
  BuiltGroup built = options.accel == AccelKind::bvh2 || options.accel == AccelKind::cwbvh
                         ? build_tree(triangles, options)
                         : list_triangles(triangles);
  GroupTree group;
  group.group = group_index;
  group.bounds = built.bounds;
  group.first_slot = static_cast<std::uint32_t>(tree.triangles.size());
  group.slot_count = static_cast<std::uint32_t>(built.order.size());
  group.node_count = static_cast<std::uint32_t>(built.bvh2.size() + built.cwbvh.size());
  if (!built.bvh2.empty()) {
    group.root = append_nodes(tree.bvh2, std::move(built.bvh2), group.first_slot);
  }
  if (!built.cwbvh.empty()) {
    group.root = append_nodes(tree.cwbvh, std::move(built.cwbvh), group.first_slot);
  }
  group.first_node = group.root;
  tree.triangles.resize(tree.triangles.size() + built.order.size());
  tbb::parallel_for(0u, group.slot_count, [&](std::uint32_t i) {
    tree.triangles[group.first_slot + i] = triangles[built.order[i]];
  });
  tree.groups.push_back(group);
  return built.builder;
}

/// Where groups differ, by all of them.
std::string joined(const std::set<std::string>& builders) {
  std::string text;
  for (const std::string& builder : builders) text += (text.empty() ? "" : "+") + builder;
  return text;
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
  std::set<std::string> builders;
  for (const std::uint32_t group : groups_in_use(instances)) {
    const MeshTriangles triangles(meshes, group);
    if (triangles.count() > 0) builders.insert(add_group(tree, triangles, group, chosen));
  }
  if (!instances.empty()) {
    add_instance_tree(tree, instances, chosen.accel);
  } else if (!tree.groups.empty()) {
    tree.root = tree.groups.front().root;
  }
  const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - begin;
  tree.build_ms = time.count();
  tree.builder = joined(builders);
  return tree;
}

}  // namespace pt
