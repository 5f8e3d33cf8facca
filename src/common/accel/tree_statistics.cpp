#include "common/accel/tree_statistics.h"

#include <algorithm>

#include "common/accel/binary_tree.h"
#include "common/accel/encode_cwbvh.h"

namespace pt {

namespace {

struct Child {
  Bounds bounds;
  bool is_inner;
  std::uint32_t place;  // of an inner node; else the number of triangles
};

template <class Visit>
void for_each_child(const Bvh2Node& node, Visit visit) {
  for (int i = 0; i < 2; ++i) {
    const std::uint32_t child = node.child[i];
    const Bounds box = child_bounds(node, i);
    if (box.min == unreachable_bounds().min) continue;
    visit(Child{box, !is_leaf(child), is_leaf(child) ? leaf_count(child) : child});
  }
}

template <class Visit>
void for_each_child(const CwbvhNode& node, Visit visit) {
  for_each_cwbvh_child(node, [&](int slot, const CwbvhChild& child) {
    const bool is_inner = child.count == 0;
    visit(Child{decode_cwbvh_bounds(node, slot), is_inner, is_inner ? child.place : child.count});
  });
}

template <class Node>
void add_subtree(std::span<const Node> nodes, const Child& inner, double root_area, int depth,
                 TreeQuality& sum) {
  ++sum.nodes;
  sum.nodes_per_ray += inner.bounds.half_area() / root_area;
  sum.depth = std::max(sum.depth, depth);
  for_each_child(nodes[inner.place], [&](const Child& child) {
    if (child.is_inner) return add_subtree(nodes, child, root_area, depth + 1, sum);
    ++sum.leaves;
    sum.slots += child.place;
    sum.triangles_per_ray += child.bounds.half_area() / root_area * child.place;
  });
}

template <class Node>
TreeQuality measure(std::span<const Node> nodes, std::uint32_t root) {
  TreeQuality sum;
  if (nodes.empty()) return sum;
  Bounds all;
  for_each_child(nodes[root], [&](const Child& child) { all.grow(child.bounds); });
  const double area = std::max(all.half_area(), 1e-37f);  // of a root without area
  add_subtree(nodes, {all, true, root}, area, 1, sum);
  return sum;
}

}  // namespace

TreeQuality measure_tree(std::span<const Bvh2Node> nodes, std::uint32_t root) {
  return measure(nodes, root);
}

TreeQuality measure_tree(std::span<const CwbvhNode> nodes, std::uint32_t root) {
  return measure(nodes, root);
}

}  // namespace pt
