// How good and how large a tree is.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>

#include "common/accel/cwbvh.h"
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

/// Of the tree below `root`.
TreeQuality measure_tree(std::span<const Bvh2Node> nodes, std::uint32_t root);
TreeQuality measure_tree(std::span<const CwbvhNode> nodes, std::uint32_t root);

/// Of groups' trees, by the numbers of their roots.
using QualityByRoot = std::unordered_map<std::uint32_t, TreeQuality>;

/// Of a tree over instances and the groups' trees together: a ray that meets an instance's box goes
/// through the group's tree. Nodes, leaves and slots of a group count once. `nodes` are those of
/// the upper level alone, the root first, and have the numbers from `first_node` on.
TreeQuality measure_instances(std::span<const Bvh2Node> nodes, std::uint32_t first_node,
                              std::span<const InstanceRecord> instances,
                              const QualityByRoot& groups);
TreeQuality measure_instances(std::span<const CwbvhNode> nodes, std::uint32_t first_node,
                              std::span<const InstanceRecord> instances,
                              const QualityByRoot& groups);

}  // namespace pt
