// How the CPU's builders write a node's children.
#pragma once

#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/build/binary/build_reference.h"

namespace pt {

/// Child `i` is the subtree of `range`: the node `index`, or a leaf where there is one reference.
inline void set_child(Bvh2Node& node, int i, const ReferenceRange& range, std::uint32_t index) {
  set_child_bounds(node, i, range.bounds.bounds());
  node.child[i] = range.size() == 1 ? make_leaf(range.begin, 1) : index;
  node.padding[i] = 0;
}

}  // namespace pt
