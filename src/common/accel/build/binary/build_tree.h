// The binary tree that the device builders make first, with one primitive per leaf; the trees for
// traversal are made from it.
#pragma once

#include "common/geometry/bounds.h"

namespace pt {

/// A subtree: the number of its primitives, counted to 15 at most, in bits 28..31; below, the
/// primitive if it is one, else the inner node's index.
using TreeRef = std::uint32_t;

inline constexpr std::uint32_t tree_primitives_max = 0x0ffffffeu;  ///< that a TreeRef can name
inline constexpr std::uint32_t many_primitives = 15;  ///< what more primitives count as

PT_HD TreeRef make_ref(std::uint32_t count, std::uint32_t index) {
  return (count < many_primitives ? count : many_primitives) << 28 | index;
}
PT_HD std::uint32_t ref_count(TreeRef ref) { return ref >> 28; }
PT_HD std::uint32_t ref_index(TreeRef ref) { return ref & 0x0fffffffu; }
PT_HD bool is_primitive(TreeRef ref) { return ref_count(ref) == 1; }

/// One sector of memory. A primitive's box has no children.
struct alignas(32) BuildNode {
  Vec3 min;
  TreeRef left;
  Vec3 max;
  TreeRef right;

  PT_HD Bounds bounds() const { return {min, max}; }
};

/// For the optimal collapse to wide nodes (Ylitie et al. 2017, section 3.1): cost[i - 1] is the
/// least cost of representing the subtree by at most i children of a wide node, 1 <= i <= 7.
struct alignas(32) CollapseTable {
  float cost[8];  ///< the last one is not used
};

/// A view.
struct BuildTree {
  const BuildNode* primitives = nullptr;  ///< [primitive]
  const BuildNode* nodes = nullptr;
  const CollapseTable* tables = nullptr;  ///< by inner node, for optimal wide nodes
  const float* binary_costs = nullptr;    ///< by inner node, for binary trees: see binary_cost
};

PT_HD BuildNode load_node(const BuildTree& tree, TreeRef ref) {
  return load_wide((is_primitive(ref) ? tree.primitives : tree.nodes) + ref_index(ref));
}

/// Calls visit(primitive) for the primitives of a subtree of less than `many_primitives`.
template <class Visit>
PT_HD void for_each_primitive(const BuildTree& tree, TreeRef ref, Visit&& visit) {
  TreeRef stack[many_primitives];
  int depth = 0;
  stack[depth++] = ref;
  while (depth > 0) {
    const TreeRef top = stack[--depth];
    if (is_primitive(top)) {
      visit(ref_index(top));
    } else {
      const BuildNode node = load_wide(&tree.nodes[ref_index(top)]);
      stack[depth++] = node.right;
      stack[depth++] = node.left;
    }
  }
}

}  // namespace pt
