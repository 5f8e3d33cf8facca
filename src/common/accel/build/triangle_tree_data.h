// A tree over triangles in host memory, owned.
#pragma once

#include <string>
#include <vector>

#include "common/accel/triangle_tree.h"
#include "common/geometry/bounds.h"

namespace pt {

template <class Node>
using NodesVector = std::vector<Node>;

/// Where a group's tree lies in the arrays. Without instances there is one, of group 0.
struct GroupTree {
  std::uint32_t group = 0;
  std::uint32_t root = 0;
  std::uint32_t first_node = 0, node_count = 0;
  std::uint32_t first_slot = 0, slot_count = 0;
  Bounds bounds;
};

/// The arrays behind a TriangleTree. Without triangles all are empty, and every ray misses.
struct TriangleTreeData : TreeNodes<NodesVector> {
  std::vector<Triangle> triangles;  ///< by slot
  /// In the order of the top tree's leaves. The index of one is that among the scene's; the
  /// meshes of group 0, if there are any, get the number that comes after the last.
  std::vector<InstanceRecord> instances;
  std::uint32_t root = 0;
  std::vector<GroupTree> groups;     ///< in use, ascending by group
  std::uint32_t first_top_node = 0;  ///< the tree over instances fills the end of the nodes
  std::string builder;               ///< by name, joined by + where groups differ; empty: no tree
  double build_ms = 0;

  bool is_empty() const { return triangles.empty(); }
  /// Calls function(pointer in `tree`, vector, kind of memory) for each array: the only list of
  /// them.
  template <class Function>
  void for_each_array(TriangleTree& tree, Function&& function) const {
    for_each_nodes(tree, [&](const auto& nodes, auto& pointer) {
      function(pointer, nodes, "acceleration structure");
    });
    function(tree.triangles, triangles, "triangles");
    function(tree.instances, instances, "instances");
  }
  /// With the arrays where `place`, called as by for_each_array, sets their pointers.
  template <class Function>
  TriangleTree view(Function&& place) const {
    TriangleTree tree;
    tree.triangle_count = static_cast<std::uint32_t>(triangles.size());
    tree.instance_count = static_cast<std::uint32_t>(instances.size());
    tree.root = root;
    for_each_array(tree, place);
    return tree;
  }
  /// Valid while this is neither changed nor destroyed.
  TriangleTree view() const {
    return view([](auto*& pointer, const auto& values, const char*) { pointer = values.data(); });
  }
  /// Size of nodes, triangles and instances.
  std::uint64_t size_bytes() const {
    std::uint64_t sum = 0;
    TriangleTree none;
    for_each_array(none, [&](auto* pointer, const auto& values, const char*) {
      sum += values.size() * sizeof *pointer;
    });
    return sum;
  }
};

}  // namespace pt
