#include "common/accel/build/wide/collapse_cwbvh.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include "common/accel/build/wide/collapse_choices.h"
#include "common/accel/build/wide/encode_cwbvh.h"

namespace pt {

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
