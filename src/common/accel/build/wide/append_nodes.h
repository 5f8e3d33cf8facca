// Several trees in one array.
#pragma once

#include <tbb/parallel_for.h>

#include <vector>

#include "common/accel/cwbvh.h"
#include "common/accel/nodes.h"

namespace pt {

inline void move_references(Bvh2Node& node, std::uint32_t nodes, std::uint32_t slots) {
  for (std::uint32_t& child : node.child) child += is_leaf(child) ? slots : nodes;
}
inline void move_references(CwbvhNode& node, std::uint32_t nodes, std::uint32_t slots) {
  node.child_base += nodes;
  node.triangle_base += slots;
}

/// Appends a tree whose root is its first node and whose slots begin at `first_slot` from now on;
/// the root's index is returned.
template <class Node>
std::uint32_t append_nodes(std::vector<Node>& all, std::vector<Node>&& nodes,
                           std::uint32_t first_slot) {
  const std::size_t first = all.size();
  if (first == 0) {
    all = std::move(nodes);
  } else {
    all.insert(all.end(), nodes.begin(), nodes.end());
  }
  const auto root = static_cast<std::uint32_t>(first);
  if (root != 0 || first_slot != 0) {
    tbb::parallel_for(first, all.size(),
                      [&](std::size_t i) { move_references(all[i], root, first_slot); });
  }
  return root;
}

}  // namespace pt
