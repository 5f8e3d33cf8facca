// Which subtrees of the binary tree become the children of a wide node.
#pragma once

#include "common/accel/build/wide/collapse_cost.h"

namespace pt {

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

/// Opens the largest child until there are eight; subtrees that may be leaves are leaves.
PT_HD WideChildren greedy_children(const BuildTree& tree, const TreeCosts& costs, TreeRef root) {
  const std::uint32_t leaf_max = wide_leaf_max(costs);
  WideChildren children;
  float area[cwbvh_width];  // negative: stays closed
  PT_UNROLL(8)
  for (int i = 0; i < cwbvh_width; ++i) children.ref[i] = root, area[i] = -1.0f;
  children.count = 1;
  area[0] = is_primitive(root) ? -1.0f : 0.0f;
  while (children.count < cwbvh_width) {
    int best = 0;
    float best_area = area[0];
    PT_UNROLL(8)
    for (int i = 1; i < cwbvh_width; ++i) {
      if (area[i] > best_area) best = i, best_area = area[i];
    }
    if (!(best_area >= 0.0f)) break;
    const BuildNode node = load_node(tree, detail::get_at(children.ref, best));
    const auto area_of = [&](TreeRef ref) {
      if (ref_count(ref) <= leaf_max) return -1.0f;
      return fmaxf(load_node(tree, ref).bounds().half_area(), 0.0f);  // NaN counts as 0
    };
    detail::set_at(children.ref, best, node.left);
    detail::set_at(area, best, area_of(node.left));
    detail::set_at(children.ref, children.count, node.right);
    detail::set_at(area, children.count, area_of(node.right));
    ++children.count;
  }
  PT_UNROLL(8)
  for (int i = 0; i < cwbvh_width; ++i) {
    if (i < children.count && ref_count(children.ref[i]) <= leaf_max) {
      children.leaf_mask |= 1u << i;
    }
  }
  return children;
}

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
