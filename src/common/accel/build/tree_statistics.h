// How good and how large a tree is, whoever built it and wherever it lies.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>

#include "common/accel/build/triangle_tree_data.h"
#include "common/accel/nodes.h"
#include "common/accel/triangle_tree.h"

namespace pt {

struct TreeQuality {
  /// Expected number of nodes that a ray visits, and of triangles that it tests, given that it
  /// meets the root's box: sums of areas relative to the root's (the surface area heuristic).
  double nodes_per_ray = 0, triangles_per_ray = 0;
  std::uint64_t nodes = 0, leaves = 0;
  std::uint64_t slots = 0;  ///< in leaves; more than triangles where these are split
  int depth = 0;            ///< nodes from the root to the deepest one, both counted

  /// In units of one node's visit.
  double sah_cost(double triangle_cost) const {
    return nodes_per_ray + triangle_cost * triangles_per_ray;
  }
};

/// Measures the tree below `root`.
TreeQuality measure_tree(std::span<const Bvh2Node> nodes, std::uint32_t root);
TreeQuality measure_tree(std::span<const CwbvhNode> nodes, std::uint32_t root);

/// Qualities of groups' trees, by the numbers of their roots.
using QualityByRoot = std::unordered_map<std::uint32_t, TreeQuality>;

/// Measures a tree over instances and the groups' trees together: a ray that meets an instance's
/// box goes through the group's tree. Nodes, leaves and slots of a group count once. `nodes` are
/// those of the upper level alone, the root first, and have the numbers from `first_node` on.
TreeQuality measure_instances(std::span<const Bvh2Node> nodes, std::uint32_t first_node,
                              std::span<const InstanceRecord> instances,
                              const QualityByRoot& groups);
TreeQuality measure_instances(std::span<const CwbvhNode> nodes, std::uint32_t first_node,
                              std::span<const InstanceRecord> instances,
                              const QualityByRoot& groups);

/// What is reported of a finished tree.
struct TreeSummary {
  std::string builder;           ///< by name; empty: there is no tree
  TreeQuality quality;           ///< of both levels where there are instances
  std::uint64_t size_bytes = 0;  ///< of nodes, triangles and instances
  double build_ms = 0;           ///< on the CPU wall time; on CUDA of kernels, and the CPU's share
};

TreeSummary summarize(const TriangleTreeData& tree);

}  // namespace pt
