#include "common/accel/build/wide/collapse_cwbvh.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include "common/accel/build/binary/parallel.h"
#include "common/accel/build/wide/encode_cwbvh.h"
#include "common/accel/build/wide/wide_children.h"

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

namespace {

constexpr std::uint32_t task_min = 256;  // wide nodes of a subtree that is worth a task

/// The wide nodes and triangles of a subtree.
struct Counts {
  std::uint32_t nodes = 0, slots = 0;
};

class Collapser {
 public:
  Collapser(const BinaryTree& tree, const TreeCosts& costs)
      : tree_(tree), choices_(tree, costs), counts_(new Counts[tree.node_capacity]) {}

  Cwbvh collapse() {
    if (is_leaf(tree_.root)) {
      single_leaf();
    } else {
      const Counts all = count(tree_.root, 0);
      result_.nodes.resize(all.nodes);
      result_.order.resize(all.slots);
      emit(tree_.root, 0, 1, 0);
    }
    return std::move(result_);
  }

 private:
  void single_leaf() {
    CwbvhChildren children;
    children.count = 1;
    children.bounds[0] = tree_.bounds;
    children.triangles[0] = 1;
    result_.nodes = {encode_cwbvh_node(children, assign_cwbvh_slots(children), 1, 0)};
    result_.order = {tree_.order[leaf_first(tree_.root)]};
  }

  Counts count(std::uint32_t index, int depth) {
    const CollapsedChildren children = choices_.children_of(index);
    Counts part[cwbvh_width];
    const auto count_child = [&](int c) {
      const CollapsedChild& child = children.child[c];
      part[c] = child.is_inner ? count(child.subtree, depth + 1)
                               : Counts{0, choices_.members_of(child.subtree).size()};
    };
    if (depth < 4) {
      tbb::parallel_for(0, children.count, count_child);
    } else {
      for (int c = 0; c < children.count; ++c) count_child(c);
    }
    Counts sum{1, 0};
    for (int c = 0; c < children.count; ++c) {
      sum.nodes += part[c].nodes, sum.slots += part[c].slots;
    }
    return counts_[index] = sum;
  }

  // Below a node come its inner children side by side, then what is below the first, and so on; the
  // slots of its own leaves come before those below.
  void emit(std::uint32_t index, std::uint32_t to, std::uint32_t below, std::uint32_t slot) {
    const CollapsedChildren children = choices_.children_of(index);
    CwbvhChildren boxes;
    boxes.count = children.count;
    LeafMembers members[cwbvh_width];
    for (int c = 0; c < children.count; ++c) {
      const CollapsedChild& child = children.child[c];
      boxes.bounds[c] = child.bounds;
      if (!child.is_inner) members[c] = choices_.members_of(child.subtree);
      boxes.triangles[c] = child.is_inner ? 0 : members[c].size();
    }
    const CwbvhSlots slots = assign_cwbvh_slots(boxes);
    result_.nodes[to] = encode_cwbvh_node(boxes, slots, below, slot);
    std::uint32_t inner[cwbvh_width];
    int inner_count = 0;
    for (const std::uint8_t c : slots.child) {
      if (c == no_cwbvh_child) continue;
      if (children.child[c].is_inner) inner[inner_count++] = children.child[c].subtree;
      for (const std::uint32_t id : members[c]) result_.order[slot++] = id;
    }
    emit_below(inner, inner_count, below, slot);
  }

  void emit_below(const std::uint32_t* inner, int inner_count, std::uint32_t first,
                  std::uint32_t slot) {
    Counts begin[cwbvh_width + 1];
    begin[0] = {first + static_cast<std::uint32_t>(inner_count), slot};
    for (int i = 0; i < inner_count; ++i) {
      const Counts& size = counts_[inner[i]];
      begin[i + 1] = {begin[i].nodes + size.nodes - 1, begin[i].slots + size.slots};
    }
    const auto emit_child = [&](int i) {
      emit(inner[i], first + static_cast<std::uint32_t>(i), begin[i].nodes, begin[i].slots);
    };
    if (begin[inner_count].nodes - begin[0].nodes >= task_min) {
      tbb::parallel_for(0, inner_count, emit_child);
    } else {
      for (int i = 0; i < inner_count; ++i) emit_child(i);
    }
  }

  const BinaryTree& tree_;
  CollapseChoices choices_;
  std::unique_ptr<Counts[]> counts_;  // by binary node; known where a wide node has its root
  Cwbvh result_;
};

}  // namespace

Cwbvh collapse_cwbvh(const BinaryTree& tree, const TreeCosts& costs) {
  return Collapser(tree, costs).collapse();
}

}  // namespace pt
