// Which subtrees of the device's binary tree become the children of a wide node, and which are
// leaves, by the surface area heuristic. Costs are areas (half areas, as Bounds has them) times the
// cost of one step.
#pragma once

#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/build/binary/build_tree.h"
#include "common/accel/build/wide/encode_cwbvh.h"
#include "common/accel/nodes.h"

namespace pt {

PT_HD std::uint32_t wide_leaf_max(const TreeCosts& costs) {
  return costs.leaf_max < cwbvh_leaf_max ? costs.leaf_max : cwbvh_leaf_max;
}

/// The cost of a subtree as a leaf of a wide node; infinite when it has too many triangles. Those
/// of a leaf are tested side by side: two take the time of one.
PT_HD float wide_leaf_cost(const TreeCosts& costs, float area, std::uint32_t count) {
  return count <= wide_leaf_max(costs) ? area * costs.triangle : HUGE_VALF;
}

PT_HD CollapseTable primitive_table(const TreeCosts& costs, float area) {
  CollapseTable table;
  for (float& cost : table.cost) cost = wide_leaf_cost(costs, area, 1);
  return table;
}

/// The least cost of representing two subtrees by j children in all, 2 <= j <= 8, and the first
/// one's share of them.
struct ChildSplit {
  float cost = HUGE_VALF;
  int left = 1;
};

PT_HD ChildSplit split_children(const CollapseTable& a, const CollapseTable& b, int j) {
  ChildSplit best;
  PT_UNROLL(7)
  for (int k = 1; k < cwbvh_width; ++k) {
    if (k >= j) continue;
    const float cost = a.cost[k - 1] + b.cost[j - k - 1];
    if (cost < best.cost) best = {cost, k};
  }
  return best;
}

/// The table of the node that joins two subtrees.
PT_HD CollapseTable join_tables(const TreeCosts& costs, const CollapseTable& a,
                                const CollapseTable& b, float area, std::uint32_t count) {
  CollapseTable table;
  const float inner = split_children(a, b, cwbvh_width).cost + area * costs.node;
  table.cost[0] = fminf(inner, wide_leaf_cost(costs, area, count));
  PT_UNROLL(6)
  for (int j = 2; j < cwbvh_width; ++j) {
    table.cost[j - 1] = fminf(table.cost[j - 2], split_children(a, b, j).cost);
  }
  table.cost[cwbvh_width - 1] = 0;
  return table;
}

/// The cost of a subtree as a leaf of a binary tree; infinite when it has too many triangles.
/// costs.leaf_max < many_primitives.
PT_HD float binary_leaf_cost(const TreeCosts& costs, float area, std::uint32_t count) {
  return count <= costs.leaf_max ? area * static_cast<float>(count) * costs.triangle : HUGE_VALF;
}

/// The least cost of the node that joins two subtrees of costs `a` and `b`, as a node or a leaf.
PT_HD float binary_cost(const TreeCosts& costs, float a, float b, float area, std::uint32_t count) {
  const float inner = a + b + area * costs.node;
  return fminf(inner, binary_leaf_cost(costs, area, count));
}

/// Whether a subtree, whose box has half the surface `area`, is to be a leaf of the binary tree.
PT_HD bool is_binary_leaf(const BuildTree& tree, const TreeCosts& costs, TreeRef ref, float area) {
  if (ref_count(ref) > costs.leaf_max) return false;
  return is_primitive(ref) ||
         binary_leaf_cost(costs, area, ref_count(ref)) <= tree.binary_costs[ref_index(ref)];
}

/// In any order.
struct WideChildren {
  int count = 0;
  std::uint32_t leaf_mask = 0;  ///< bit c: child c is a leaf
  TreeRef ref[cwbvh_width];
};

namespace detail {

// An array that stays in registers: elements are found by comparing, not by addressing.
template <class T>
PT_HD void set_at(T (&array)[cwbvh_width], int index, T value) {
  PT_UNROLL(8)
  for (int i = 0; i < cwbvh_width; ++i) array[i] = i == index ? value : array[i];
}
template <class T>
PT_HD T get_at(const T (&array)[cwbvh_width], int index) {
  T value = array[0];
  PT_UNROLL(8)
  for (int i = 1; i < cwbvh_width; ++i) value = i == index ? array[i] : value;
  return value;
}

}  // namespace detail

PT_HD CollapseTable load_table(const BuildTree& tree, const TreeCosts& costs, TreeRef ref) {
  if (is_primitive(ref)) {
    return primitive_table(costs, load_node(tree, ref).bounds().half_area());
  }
  return load_wide(&tree.tables[ref_index(ref)]);
}

/// The children that the tables found cheapest.
PT_HD WideChildren optimal_children(const BuildTree& tree, const TreeCosts& costs, TreeRef root) {
  WideChildren children;
  int share[cwbvh_width];  // children that a subtree may still become
  PT_UNROLL(8)
  for (int i = 0; i < cwbvh_width; ++i) children.ref[i] = root, share[i] = 1;
  children.count = 1;
  share[0] = is_primitive(root) ? 1 : cwbvh_width;
  for (int i = 0; i < children.count;) {
    const TreeRef ref = detail::get_at(children.ref, i);
    int j = detail::get_at(share, i);
    if (j == 1 || is_primitive(ref)) {
      ++i;
      continue;
    }
    const BuildNode node = load_wide(&tree.nodes[ref_index(ref)]);
    const CollapseTable own = load_wide(&tree.tables[ref_index(ref)]);
    const CollapseTable a = load_table(tree, costs, node.left);
    const CollapseTable b = load_table(tree, costs, node.right);
    ChildSplit split = split_children(a, b, j);
    // Fewer children may cost less; the root has no choice.
    while (j < cwbvh_width && j > 1 && own.cost[j - 2] < split.cost) {
      split = split_children(a, b, --j);
    }
    if (j == 1) {
      ++i;
      continue;
    }
    detail::set_at(children.ref, i, node.left);
    detail::set_at(share, i, split.left);
    detail::set_at(children.ref, children.count, node.right);
    detail::set_at(share, children.count, j - split.left);
    ++children.count;
  }
  PT_UNROLL(8)
  for (int i = 0; i < cwbvh_width; ++i) {
    const TreeRef ref = children.ref[i];
    if (i >= children.count || ref_count(ref) > wide_leaf_max(costs)) continue;
    const float leaf =
        wide_leaf_cost(costs, load_node(tree, ref).bounds().half_area(), ref_count(ref));
    if (is_primitive(ref) || leaf <= load_wide(&tree.tables[ref_index(ref)]).cost[0]) {
      children.leaf_mask |= 1u << i;
    }
  }
  return children;
}

}  // namespace pt
