#include "common/accel/build/binary/build_binary.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <bit>

#include "common/accel/build/binary/build_children.h"
#include "common/accel/build/binary/invoke_both.h"
#include "common/accel/build/binary/split.h"

namespace pt {

namespace {

constexpr std::uint32_t task_min = 1024;  // references of a subtree that is worth a task

class SahBuilder {
 public:
  explicit SahBuilder(std::span<BuildReference> references)
      : references_(references), nodes_(new Bvh2Node[references.size()]) {}

  std::unique_ptr<Bvh2Node[]> build(const ReferenceRange& all) {
    if (all.size() > 1) build_node(all, 0, 0);
    return std::move(nodes_);
  }

 private:
  // A subtree of n references has n - 1 nodes, so each node's index is known beforehand and threads
  // need not agree on anything.
  void build_node(const ReferenceRange& range, std::uint32_t index, int depth) {
    const RangeHalves halves = split(range, depth);
    const ReferenceRange& left = halves.left;
    const ReferenceRange& right = halves.right;
    const std::uint32_t children[2] = {index + 1, index + left.size()};
    Bvh2Node& node = nodes_[index];
    set_child(node, 0, left, children[0]);
    set_child(node, 1, right, children[1]);
    const auto build_left = [&] {
      if (left.size() > 1) build_node(left, children[0], depth + 1);
    };
    const auto build_right = [&] {
      if (right.size() > 1) build_node(right, children[1], depth + 1);
    };
    invoke_both(range.size() >= task_min, build_left, build_right);
  }

  RangeHalves split(const ReferenceRange& range, int depth) const {
    if (range.size() == 2) return split_in_halves(references_, range);
    const ObjectSplit best = find_object_split(references_, range);
    if (best.cost == HUGE_VALF) return split_in_halves(references_, range);
    const RangeHalves halves = partition_references(references_, range, best);
    const std::uint32_t larger = std::max(halves.left.size(), halves.right.size());
    const bool too_deep = depth + 1 + std::bit_width(larger - 1) > bvh_depth_max;
    return too_deep ? split_in_halves(references_, range) : halves;
  }

  std::span<BuildReference> references_;
  std::unique_ptr<Bvh2Node[]> nodes_;
};

}  // namespace

BinaryTree build_sah(std::uint32_t count, const BoundsOf& bounds_of) {
  const std::unique_ptr<BuildReference[]> memory(new BuildReference[count]);
  const std::span<BuildReference> references(memory.get(), count);
  ReferenceRange all = tbb::parallel_reduce(
      tbb::blocked_range<std::uint32_t>(0, count, 1 << 13), ReferenceRange(),
      [&](const auto& part, ReferenceRange sum) {
        for (std::uint32_t i = part.begin(); i < part.end(); ++i) {
          references[i] = make_reference(bounds_of(i), i);
          sum.grow(references[i]);
        }
        return sum;
      },
      [](ReferenceRange a, const ReferenceRange& b) { return a.grow(b), a; });
  all.end = count;
  BinaryTree tree;
  tree.bounds = all.bounds.bounds();
  tree.root = count == 1 ? make_leaf(0, 1) : 0;
  tree.node_capacity = count;
  tree.nodes = SahBuilder(references).build(all);
  tree.order.resize(count);
  tbb::parallel_for(0u, count, [&](std::uint32_t i) { tree.order[i] = references[i].id(); });
  return tree;
}

}  // namespace pt
