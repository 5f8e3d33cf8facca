// The surface area heuristic's cost of finished nodes.
#pragma once

#include "common/accel/bvh2.h"
#include "common/accel/collapse_cost.h"

namespace pt {

/// What one node's children add to a tree.
struct NodeCost {
  double area_cost = 0;  ///< half area of each child's box times the cost of what is there
  std::uint32_t inner_children = 0, leaves = 0, leaf_primitives = 0;

  PT_HD void add(const CollapseCosts& costs, float half_area, std::uint32_t primitives) {
    const float step =
        primitives == 0 ? costs.node : costs.triangle * static_cast<float>(primitives);
    area_cost += static_cast<double>(half_area) * static_cast<double>(step);
    inner_children += primitives == 0 ? 1u : 0u;
    leaves += primitives == 0 ? 0u : 1u;
    leaf_primitives += primitives;
  }
};

PT_HD NodeCost node_cost(const Bvh2Node& node, const CollapseCosts& costs) {
  NodeCost sum;
  for (int i = 0; i < 2; ++i) {
    const Bounds box{{node.xy[i].x, node.xy[i].z, node.z[2 * i]},
                     {node.xy[i].y, node.xy[i].w, node.z[2 * i + 1]}};
    const std::uint32_t child = node.child[i];
    sum.add(costs, box.half_area(), is_leaf(child) ? leaf_count(child) : 0);
  }
  return sum;
}

PT_HD NodeCost node_cost(const CwbvhNode& node, const CollapseCosts& costs) {
  NodeCost sum;
  for (int s = 0; s < cwbvh_width; ++s) {
    if (node.meta[s] == 0) continue;
    const std::uint32_t unary = node.meta[s] >> 5;
    const std::uint32_t count = unary == 7 ? 3 : unary == 3 ? 2 : 1;
    const bool is_inner = (node.inner_mask >> s & 1) != 0;
    sum.add(costs, decode_cwbvh_bounds(node, s).half_area(), is_inner ? 0 : count);
  }
  return sum;
}

}  // namespace pt
