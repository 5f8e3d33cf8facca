// What the CPU's builders do alike with the two halves of a node.
#pragma once

#include <tbb/parallel_invoke.h>

#include "common/accel/binary_tree.h"
#include "common/accel/build_reference.h"

namespace pt {

/// Child `i` is the subtree of `range`: the node `index`, or a leaf where there is one reference.
inline void set_child(Bvh2Node& node, int i, const ReferenceRange& range, std::uint32_t index) {
  set_child_bounds(node, i, widened(range.bounds.bounds()));
  node.child[i] = range.size() == 1 ? make_leaf(range.begin, 1) : index;
  node.padding[i] = 0;
}

/// Builds both halves of a subtree, side by side or one after the other.
template <class Left, class Right>
void build_halves(bool in_parallel, const Left& left, const Right& right) {
  if (in_parallel) {
    tbb::parallel_invoke(left, right);
  } else {
    left(), right();
  }
}

}  // namespace pt
