#include "common/accel/build/wide/collapse_choices.h"

#include "common/accel/build/binary/invoke_both.h"
#include "common/accel/build/wide/collapse_cost.h"

namespace pt {

namespace {

constexpr int task_depth = 10;  // so far down, the two children are tasks of their own

}  // namespace

CollapseChoices::CollapseChoices(const BinaryTree& tree, const TreeCosts& costs)
    : tree_(tree), costs_(costs), entries_(new Entry[tree.node_capacity]) {
  if (!is_leaf(tree.root)) choose(tree.root, tree.bounds.half_area(), 0);
}

CollapseChoices::Below CollapseChoices::choose(std::uint32_t subtree, float area, int depth) {
  Below below{{}, area};
  if (is_leaf(subtree)) {
    below.members.add(tree_.order[leaf_first(subtree)]);
    return below;
  }
  const Bvh2Node& node = tree_.nodes[subtree];
  Below half[2];
  const auto choose_half = [&](int i) {
    half[i] = choose(node.child[i], child_bounds(node, i).half_area(), depth + 1);
  };
  invoke_both(
      depth < task_depth, [&] { choose_half(0); }, [&] { choose_half(1); });
  below.members = half[0].members;
  below.members.add(half[1].members);
  Entry& entry = entries_[subtree];
  share_out(node, half, entry);
  const float leaf_cost = wide_leaf_cost(costs_, area, below.members.size());
  const float inner_cost = costs_.node * area + entry.cost[0];
  const bool is_inner = inner_cost < leaf_cost;
  entry.share[0] = is_inner ? 1 : 0;
  entry.cost[0] = is_inner ? inner_cost : leaf_cost;
  for (int i = 1; i < 7; ++i) {
    if (entry.cost[i - 1] <= entry.cost[i]) entry.cost[i] = entry.cost[i - 1], entry.share[i] = 0;
  }
  return below;
}

// The costs of forests of 2..7, and that of eight, for the time being, as that of one.
void CollapseChoices::share_out(const Bvh2Node& node, const Below (&half)[2], Entry& entry) const {
  for (int forest = 2; forest <= 8; ++forest) {
    float best = HUGE_VALF;
    for (int first = 1; first < forest; ++first) {
      const float cost = cost_of(node.child[0], half[0].area, std::min(first, 7)) +
                         cost_of(node.child[1], half[1].area, std::min(forest - first, 7));
      if (cost < best) {
        best = cost;
        entry.share[forest - 1] = static_cast<std::uint8_t>(first);
      }
    }
    entry.cost[forest == 8 ? 0 : forest - 1] = best;
  }
}

float CollapseChoices::cost_of(std::uint32_t subtree, float area, int forest) const {
  return is_leaf(subtree) ? wide_leaf_cost(costs_, area, 1) : entries_[subtree].cost[forest - 1];
}

void CollapseChoices::gather(std::uint32_t subtree, const Bounds& bounds, int forest,
                             CollapsedChildren& children) const {
  if (!is_leaf(subtree)) {
    const Entry& entry = entries_[subtree];
    while (forest > 1 && entry.share[forest - 1] == 0) --forest;
    if (forest > 1) {
      const Bvh2Node& node = tree_.nodes[subtree];
      const int first = entry.share[forest - 1];
      gather(node.child[0], child_bounds(node, 0), first, children);
      gather(node.child[1], child_bounds(node, 1), forest - first, children);
      return;
    }
  }
  const bool is_inner = !is_leaf(subtree) && entries_[subtree].share[0] != 0;
  children.child[children.count++] = {subtree, is_inner, bounds};
}

CollapsedChildren CollapseChoices::children_of(std::uint32_t index) const {
  CollapsedChildren children;
  const Bvh2Node& node = tree_.nodes[index];
  const int first = entries_[index].share[7];
  gather(node.child[0], child_bounds(node, 0), first, children);
  gather(node.child[1], child_bounds(node, 1), 8 - first, children);
  return children;
}

LeafMembers CollapseChoices::members_of(std::uint32_t subtree) const {
  LeafMembers members;
  if (is_leaf(subtree)) {
    members.add(tree_.order[leaf_first(subtree)]);
  } else {
    for (const std::uint32_t child : tree_.nodes[subtree].child) members.add(members_of(child));
  }
  return members;
}

}  // namespace pt
