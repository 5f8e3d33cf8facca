#include "common/accel/build/binary/build_bvh2.h"

#include <algorithm>

#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/build/binary/build_binary.h"
#include "common/accel/build/binary/parallel.h"

namespace pt {
namespace {

constexpr int task_depth = 10;  // so far down, the two children are tasks of their own

class Merger {
 public:
  Merger(BinaryTree& tree, const TreeCosts& costs, std::uint32_t first_of_second_kind)
      : tree_(tree), costs_(costs), second_kind_(first_of_second_kind) {}

  Bvh2 merge() {
    const Subtree all = weigh(tree_.root, tree_.bounds.half_area(), 0);
    result_.nodes.resize(std::max(all.nodes, 1u));
    result_.order.resize(all.slots);
    if (all.nodes == 0) {
      Bvh2Node& root = result_.nodes[0] = {};
      set_child_bounds(root, 0, tree_.bounds);
      root.child[0] = root.child[1] = emit_leaf(tree_.root, 0);
      set_child_bounds(root, 1, unreachable_bounds());
    } else {
      emit(tree_.root, 0, 0, 0);
    }
    return std::move(result_);
  }

 private:
  struct Subtree {
    float cost = 0;
    std::uint32_t nodes = 0, slots = 0;  // of the result
    LeafMembers members;
  };

  // Decides which subtrees become leaves and leaves the sizes of the others in their padding.
  Subtree weigh(std::uint32_t child, float area, int depth) {
    Subtree sum;
    if (is_leaf(child)) {
      sum.members.add(tree_.order[leaf_first(child)]);
      return as_leaf(sum, area);
    }
    Bvh2Node& node = tree_.nodes[child];
    Subtree half[2];
    const auto weigh_half = [&](int i) {
      half[i] = weigh(node.child[i], child_bounds(node, i).half_area(), depth + 1);
    };
    invoke_both(
        depth < task_depth, [&] { weigh_half(0); }, [&] { weigh_half(1); });
    sum.cost = costs_.node * area + half[0].cost + half[1].cost;
    sum.nodes = 1 + half[0].nodes + half[1].nodes;
    sum.slots = half[0].slots + half[1].slots;
    sum.members = half[0].members;
    sum.members.add(half[1].members);
    if (sum.members.size() <= costs_.leaf_max && are_of_one_kind(sum.members)) {
      const Subtree leaf = as_leaf(sum, area);
      if (leaf.cost <= sum.cost) sum = leaf;
    }
    node.padding[0] = sum.nodes;
    node.padding[1] = sum.slots;
    return sum;
  }

  Subtree as_leaf(Subtree sum, float area) const {
    sum.cost = costs_.triangle * area * static_cast<float>(sum.members.size());
    sum.nodes = 0;
    sum.slots = sum.members.size();
    return sum;
  }

  bool are_of_one_kind(const LeafMembers& members) const {
    const auto is_second = [&](std::uint32_t i) { return i >= second_kind_; };
    return std::all_of(members.begin(), members.end(), is_second) ||
           std::none_of(members.begin(), members.end(), is_second);
  }

  bool becomes_leaf(std::uint32_t child) const {
    return is_leaf(child) || tree_.nodes[child].padding[0] == 0;
  }
  std::uint32_t slots_of(std::uint32_t child) const {
    return is_leaf(child) ? 1 : tree_.nodes[child].padding[1];
  }

  void emit(std::uint32_t from, std::uint32_t index, std::uint32_t slot, int depth) {
    const Bvh2Node& node = tree_.nodes[from];
    Bvh2Node& result = result_.nodes[index] = node;
    result.padding[0] = result.padding[1] = 0;
    const std::uint32_t first = node.child[0], second = node.child[1];
    const std::uint32_t first_nodes = becomes_leaf(first) ? 0 : tree_.nodes[first].padding[0];
    const auto emit_child = [&](int i, std::uint32_t child, std::uint32_t to, std::uint32_t at) {
      result.child[i] = becomes_leaf(child) ? emit_leaf(child, at) : to;
      if (!becomes_leaf(child)) emit(child, to, at, depth + 1);
    };
    invoke_both(
        depth < task_depth, [&] { emit_child(0, first, index + 1, slot); },
        [&] { emit_child(1, second, index + 1 + first_nodes, slot + slots_of(first)); });
  }

  std::uint32_t emit_leaf(std::uint32_t child, std::uint32_t slot) {
    LeafMembers members;
    collect(child, members);
    std::copy(members.begin(), members.end(), result_.order.begin() + slot);
    return make_leaf(slot, members.size());
  }

  void collect(std::uint32_t child, LeafMembers& members) const {
    if (is_leaf(child)) return members.add(tree_.order[leaf_first(child)]);
    for (const std::uint32_t next : tree_.nodes[child].child) collect(next, members);
  }

  BinaryTree& tree_;
  TreeCosts costs_;
  std::uint32_t second_kind_;
  Bvh2 result_;
};

}  // namespace

Bvh2 merge_leaves(BinaryTree&& tree, const TreeCosts& costs, std::uint32_t first_of_second_kind) {
  return Merger(tree, costs, first_of_second_kind).merge();
}

namespace {

// The cost of a sphere relative to a node's two boxes: measured on an H200 from 51 to 1,025
// spheres, where 0.5 is faster than 0.35, 0.7 and 1 in both modes.
constexpr TreeCosts primitive_costs = {1.0f, 0.5f, leaf_size_max};

// Sorts `order` by kind, keeping each kind's sequence, and renumbers the leaves.
void order_by_kind(Bvh2& tree, std::uint32_t first_of_second_kind) {
  const auto is_first = [&](std::uint32_t primitive) { return primitive < first_of_second_kind; };
  std::vector<std::uint32_t> new_index(tree.order.size()), sorted(tree.order.size());
  std::uint32_t first = 0;
  auto second =
      static_cast<std::uint32_t>(std::count_if(tree.order.begin(), tree.order.end(), is_first));
  for (std::size_t i = 0; i < new_index.size(); ++i) {
    new_index[i] = is_first(tree.order[i]) ? first++ : second++;
    sorted[new_index[i]] = tree.order[i];
  }
  for (Bvh2Node& node : tree.nodes) {
    for (std::uint32_t& child : node.child) {
      if (is_leaf(child)) child = make_leaf(new_index[leaf_first(child)], leaf_count(child));
    }
  }
  tree.order = std::move(sorted);
}

}  // namespace

Bvh2 build_bvh2(std::span<const Bounds> bounds, std::uint32_t first_of_second_kind, float padding) {
  BinaryTree binary =
      build_sah(static_cast<std::uint32_t>(bounds.size()), [&](std::uint32_t i) -> Bounds {
        return {bounds[i].min - padding, bounds[i].max + padding};
      });
  Bvh2 tree = merge_leaves(std::move(binary), primitive_costs, first_of_second_kind);
  order_by_kind(tree, first_of_second_kind);
  return tree;
}

}  // namespace pt
