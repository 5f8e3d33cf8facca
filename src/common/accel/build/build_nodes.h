// From binary trees to the nodes of a structure.
#pragma once

#include <vector>

#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/build/triangle_tree_data.h"
#include "common/options/options.h"

namespace pt {

struct BuiltNodes : TreeNodes<NodesVector> {
  std::vector<std::uint32_t> order;  ///< place in the leaves -> what the binary tree was built over

  std::uint32_t node_count() const;
};

/// False: every triangle is tested.
bool has_nodes(AccelKind accel);

/// The root comes first.
BuiltNodes build_nodes(BinaryTree&& binary, AccelKind accel, const TreeCosts& costs);

/// Adds `nodes` and `slots` to the numbers by which the nodes refer to nodes and to slots.
void move_references(TreeNodes<NodesVector>& tree, std::uint32_t nodes, std::uint32_t slots);

/// Appends a tree whose root is its first node and whose slots begin at `first_slot` from now on;
/// returns the root's index.
std::uint32_t append_nodes(TreeNodes<NodesVector>& all, TreeNodes<NodesVector>&& tree,
                           std::uint32_t first_slot);

}  // namespace pt
