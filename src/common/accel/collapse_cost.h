// The surface area heuristic where binary nodes are collapsed: what is a leaf, and what is a wide
// node's child. Costs are areas (half areas, as Bounds has them) times the cost of one step.
#pragma once

#include "common/accel/binary_tree.h"
#include "common/accel/build_tree.h"
#include "common/accel/cwbvh.h"
#include "common/accel/encode_cwbvh.h"

namespace pt {

PT_HD std::uint32_t wide_leaf_max(const TreeCosts& costs) {
  return costs.leaf_max < cwbvh_leaf_max ? costs.leaf_max : cwbvh_leaf_max;
}

/// The cost of a subtree as a leaf of a wide node; infinite when it has too many triangles.
PT_HD float wide_leaf_cost(const TreeCosts& costs, float area, std::uint32_t count) {
  return count <= wide_leaf_max(costs)
             ? multiply_rounded(multiply_rounded(area, static_cast<float>(count)), costs.triangle)
             : HUGE_VALF;
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

/// Whether a subtree is cheaper as one leaf of a binary node than as the best tree below it.
/// costs.leaf_max < many_primitives.
PT_HD bool is_binary_leaf(const BuildTree& tree, const TreeCosts& costs, TreeRef root) {
  if (ref_count(root) > costs.leaf_max) return false;
  if (is_primitive(root)) return true;
  struct Entry {
    TreeRef ref;
    float cost;  // a leaf's
    int parent;
  };
  Entry entries[2 * many_primitives];  // parents come before their children
  float below[2 * many_primitives];    // the sum of the children's costs
  int count = 0;
  entries[count++] = {root, 0.0f, -1};
  for (int i = 0; i < count; ++i) {
    const BuildNode node = load_node(tree, entries[i].ref);
    const float area = node.bounds().half_area();
    const TreeRef ref = entries[i].ref;
    entries[i].cost = area * static_cast<float>(ref_count(ref)) * costs.triangle;
    below[i] = is_primitive(ref) ? HUGE_VALF : area * costs.node;
    if (is_primitive(ref)) continue;
    entries[count++] = {node.left, 0.0f, i};
    entries[count++] = {node.right, 0.0f, i};
  }
  for (int i = count - 1; i > 0; --i) {
    below[entries[i].parent] += fminf(entries[i].cost, below[i]);
  }
  return entries[0].cost <= below[0];
}

}  // namespace pt
