#include "common/accel/build/build_triangle_tree.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <numeric>
#include <set>

#include "common/accel/build/binary/build_binary.h"
#include "common/accel/build/build_nodes.h"
#include "common/accel/build/instance_tree.h"
#include "common/accel/build/mesh_triangles.h"
#include "common/accel/build/try_splits.h"
#include "common/error/error.h"
#include "common/options/option_names.h"

namespace pt {
namespace {

/// The tree of one group: its root and its slots come first.
struct BuiltGroup {
  Bounds bounds;
  BuiltNodes nodes;     ///< `order`: slot -> the group's triangle
  std::string builder;  ///< by name; empty: no tree
};

BuiltGroup finish_tree(BinaryTree&& binary, const char* builder, const TreeOptions& options) {
  const Bounds bounds = binary.bounds;
  return {bounds, build_nodes(std::move(binary), options.accel, options.costs()), builder};
}

BinaryTree build_whole(const MeshTriangles& triangles) {
  return build_sah(triangles.count(), [&](std::uint32_t i) { return triangles.bounds(i); });
}

BuiltGroup build_split(const MeshTriangles& triangles, const TreeOptions& options) {
  BinaryTree binary = build_sbvh(
      triangles.count(), [&](std::uint32_t i) { return triangles[i]; }, options.sbvh);
  return finish_tree(std::move(binary), "sbvh", options);
}

void copy_by_slot(const MeshTriangles& triangles, const std::vector<std::uint32_t>& order,
                  Triangle* to) {
  tbb::parallel_for(std::size_t{0}, order.size(),
                    [&](std::size_t i) { to[i] = triangles[order[i]]; });
}

std::vector<Triangle> by_slot(const MeshTriangles& triangles,
                              const std::vector<std::uint32_t>& order) {
  std::vector<Triangle> copies(order.size());
  copy_by_slot(triangles, order, copies.data());
  return copies;
}

// When the automatic builder tries spatial splits and takes them, measured on some fifteen scenes
// (docs/design/tracing.md).
constexpr double split_share = 1.5;        // overlap_share() of a tree worth the try
constexpr double large_split_share = 2.0;  // the same from large_count triangles on
constexpr std::uint32_t large_count = 1u << 21;
constexpr std::uint32_t trial_paths = 1u << 13;
constexpr double split_gain = 0.97;  // of what trial rays cost, to be taken
// Visits of trial rays, by far more than 2^13 paths make in scenes that people model.
constexpr double trial_visits_min = 1u << 23;
constexpr double trial_visits_per_triangle = 16;

const char* improve(BinaryTree& binary) {
  std::optional<BinaryTree> improved = reinsert_nodes(binary);
  if (!improved) return "sah";
  binary = std::move(*improved);
  return "sah-reinsert";
}

/// The tree by `sah`, improved by reinsertion if it can be, or one by `sbvh` in which rays cost
/// less.
BuiltGroup build_best(const MeshTriangles& triangles, const TreeOptions& options) {
  BinaryTree binary = build_whole(triangles);
  const char* const builder = improve(binary);
  const bool is_large = triangles.count() >= large_count;
  const bool tries = overlap_share(binary) >= (is_large ? large_split_share : split_share);
  BuiltGroup whole = finish_tree(std::move(binary), builder, options);
  if (!tries) return whole;
  const double visits =
      std::max(trial_visits_min, trial_visits_per_triangle * double(triangles.count()));
  const std::vector<TrialRay> rays = trial_rays(whole.nodes, by_slot(triangles, whole.nodes.order),
                                                whole.bounds, trial_paths, visits);
  BuiltGroup split = build_split(triangles, options);
  const bool pays = trial_cost(split.nodes, rays) < split_gain * trial_cost(whole.nodes, rays);
  return pays ? split : whole;
}

BuiltGroup build_tree(const MeshTriangles& triangles, const TreeOptions& options) {
  switch (options.builder) {
    case TreeBuilder::sah:
      return finish_tree(build_whole(triangles), "sah", options);
    case TreeBuilder::sah_reinsert: {
      BinaryTree binary = build_whole(triangles);
      const char* const builder = improve(binary);
      return finish_tree(std::move(binary), builder, options);
    }
    case TreeBuilder::sbvh:
      return build_split(triangles, options);
    default:
      return build_best(triangles, options);
  }
}

BuiltGroup list_triangles(const MeshTriangles& triangles) {
  BuiltGroup list;
  std::vector<std::uint32_t>& order = list.nodes.order;
  order.resize(triangles.count());
  std::iota(order.begin(), order.end(), 0u);
  for (const std::uint32_t i : order) list.bounds.grow(triangles.bounds(i));
  return list;
}

/// Appends the group's tree, and its triangles in the order of the tree's slots. Returns who built
/// it.
std::string add_group(TriangleTreeData& tree, const MeshTriangles& triangles,
                      std::uint32_t group_index, const TreeOptions& options) {
  BuiltGroup built =
      has_nodes(options.accel) ? build_tree(triangles, options) : list_triangles(triangles);
  const std::vector<std::uint32_t>& order = built.nodes.order;
  GroupTree group;
  group.group = group_index;
  group.bounds = built.bounds;
  group.first_slot = static_cast<std::uint32_t>(tree.triangles.size());
  group.slot_count = static_cast<std::uint32_t>(order.size());
  group.node_count = built.nodes.node_count();
  group.root = group.first_node = append_nodes(tree, std::move(built.nodes), group.first_slot);
  tree.triangles.resize(tree.triangles.size() + order.size());
  copy_by_slot(triangles, order, tree.triangles.data() + group.first_slot);
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
                                     const TreeOptions& options, const MotionTracks& motion) {
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
    add_instance_tree(tree, instances, chosen.accel, motion);
  } else if (!tree.groups.empty()) {
    tree.root = tree.groups.front().root;
  }
  const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - begin;
  tree.build_ms = time.count();
  tree.builder = joined(builders);
  return tree;
}

void check_builder(TreeBuilder builder, AccelKind accel, bool on_cuda) {
  if (!is_device_builder(builder)) return;
  const std::string name = to_string(builder);
  if (!on_cuda) {
    throw Error(fmt::format(
        "--builder {}: needs a CUDA device; on the CPU expected sah, sah-reinsert, sbvh or best",
        name));
  }
  if (accel != AccelKind::bvh2 && accel != AccelKind::cwbvh) {
    throw Error(fmt::format(
        "--builder {}: builds binary and wide trees; expected --accel bvh2 or cwbvh", name));
  }
}

}  // namespace pt
