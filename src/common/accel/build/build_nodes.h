// From a binary tree to the nodes of a structure.
#pragma once

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

}  // namespace pt
