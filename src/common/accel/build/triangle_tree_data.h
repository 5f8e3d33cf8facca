// A tree over triangles in host memory, owned.
#pragma once

#include <string>
#include <vector>

#include "common/accel/build/tree_statistics.h"
#include "common/accel/triangle_tree.h"
#include "common/geometry/bounds.h"

namespace pt {

/// Where a group's tree lies in the arrays. Without instances there is one, of group 0.
struct GroupTree {
  std::uint32_t group = 0;
  std::uint32_t root = 0;
  std::uint32_t first_node = 0, node_count = 0;
  std::uint32_t first_slot = 0, slot_count = 0;
  Bounds bounds;
};

/// The arrays behind a TriangleTree. Without triangles all are empty, and every ray misses.
struct TriangleTreeData {
  std::vector<Bvh2Node> bvh2;  ///< one of the two, or none where every triangle is tested
  std::vector<CwbvhNode> cwbvh;
  std::vector<Triangle> triangles;  ///< by slot
  /// In the order of the top tree's leaves. The number of one is its place among the scene's; the
  /// meshes of group 0, if there are any, get the number that comes after the last.
  std::vector<InstanceRecord> instances;
  std::uint32_t root = 0;
  std::vector<GroupTree> groups;     ///< in use, ascending by group
  std::uint32_t first_top_node = 0;  ///< the tree over instances fills the end of the nodes
  std::string builder;               ///< by name; empty: no tree
  double build_ms = 0;

  bool is_empty() const { return triangles.empty(); }
  /// Valid while this is neither changed nor destroyed.
  TriangleTree view() const {
    return {bvh2.data(),
            cwbvh.data(),
            triangles.data(),
            instances.data(),
            static_cast<std::uint32_t>(triangles.size()),
            static_cast<std::uint32_t>(instances.size()),
            root};
  }
  /// Of nodes, triangles and instances.
  std::uint64_t size_bytes() const {
    return bvh2.size() * sizeof(Bvh2Node) + cwbvh.size() * sizeof(CwbvhNode) +
           triangles.size() * sizeof(Triangle) + instances.size() * sizeof(InstanceRecord);
  }
};

}  // namespace pt
