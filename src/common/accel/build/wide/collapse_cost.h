// The surface area heuristic where binary nodes are collapsed: what is a leaf, and what is a wide
// node's child. Costs are areas (half areas, as Bounds has them) times the cost of one step.
#pragma once

#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/build/binary/build_tree.h"
#include "common/accel/build/wide/encode_cwbvh.h"
#include "common/accel/cwbvh.h"

namespace pt {

PT_HD std::uint32_t wide_leaf_max(const TreeCosts& costs) {
  return costs.leaf_max < cwbvh_leaf_max ? costs.leaf_max : cwbvh_leaf_max;
}

/// The cost of a subtree as a leaf of a wide node; infinite when it has too many triangles. Those
/// of a leaf are tested side by side: two take the time of one.
PT_HD float wide_leaf_cost(const TreeCosts& costs, float area, std::uint32_t count) {
  return count <= wide_leaf_max(costs) ? multiply_rounded(area, costs.triangle) : HUGE_VALF;
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
    const float cost = add_rounded(a.cost[k - 1], b.cost[j - k - 1]);
    if (cost < best.cost) best = {cost, k};
  }
  return best;
}

/// The table of the node that joins two subtrees.
PT_HD CollapseTable join_tables(const TreeCosts& costs, const CollapseTable& a,
                                const CollapseTable& b, float area, std::uint32_t count) {
  CollapseTable table;
  const float inner =
      add_rounded(split_children(a, b, cwbvh_width).cost, multiply_rounded(area, costs.node));
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
  return count <= costs.leaf_max
             ? multiply_rounded(multiply_rounded(area, static_cast<float>(count)), costs.triangle)
             : HUGE_VALF;
}

/// The least cost of the node that joins two subtrees of costs `a` and `b`, as a node or a leaf.
PT_HD float binary_cost(const TreeCosts& costs, float a, float b, float area, std::uint32_t count) {
  const float inner = add_rounded(add_rounded(a, b), multiply_rounded(area, costs.node));
  return fminf(inner, binary_leaf_cost(costs, area, count));
}

/// Whether a subtree, whose box has half the surface `area`, is to be a leaf of the binary tree.
PT_HD bool is_binary_leaf(const BuildTree& tree, const TreeCosts& costs, TreeRef ref, float area) {
  if (ref_count(ref) > costs.leaf_max) return false;
  return is_primitive(ref) ||
         binary_leaf_cost(costs, area, ref_count(ref)) <= tree.binary_costs[ref_index(ref)];
}

}  // namespace pt
