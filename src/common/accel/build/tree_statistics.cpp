#include "common/accel/build/tree_statistics.h"

#include <algorithm>

#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/build/wide/encode_cwbvh.h"

namespace pt {
namespace {

struct Child {
  Bounds bounds;
  bool is_inner;
  std::uint32_t index;      // of an inner node, or a leaf's first slot
  std::uint32_t count = 0;  // of a leaf's slots
};

template <class Visit>
void for_each_child(const Bvh2Node& node, Visit visit) {
  for (int i = 0; i < 2; ++i) {
    const std::uint32_t child = node.child[i];
    const Bounds box = child_bounds(node, i);
    if (box.min == unreachable_bounds().min) continue;
    visit(is_leaf(child) ? Child{box, false, leaf_first(child), leaf_count(child)}
                         : Child{box, true, child});
  }
}

template <class Visit>
void for_each_child(const CwbvhNode& node, Visit visit) {
  for_each_cwbvh_child(node, [&](int slot, const CwbvhChild& child) {
    visit(Child{decode_cwbvh_bounds(node, slot), child.count == 0, child.index, child.count});
  });
}

/// Calls add_leaf(child, its area relative to the root's, depth of its node, sum) for the leaves.
template <class Node, class AddLeaf>
void add_subtree(std::span<const Node> nodes, std::uint32_t first_node, const Child& inner,
                 double root_area, int depth, const AddLeaf& add_leaf, TreeQuality& sum) {
  ++sum.nodes;
  sum.nodes_per_ray += inner.bounds.half_area() / root_area;
  sum.depth = std::max(sum.depth, depth);
  for_each_child(nodes[inner.index - first_node], [&](const Child& child) {
    if (child.is_inner) {
      add_subtree(nodes, first_node, child, root_area, depth + 1, add_leaf, sum);
    } else {
      add_leaf(child, child.bounds.half_area() / root_area, depth, sum);
    }
  });
}

template <class Node, class AddLeaf>
TreeQuality measure(std::span<const Node> nodes, std::uint32_t first_node, std::uint32_t root,
                    const AddLeaf& add_leaf) {
  TreeQuality sum;
  if (nodes.empty()) return sum;
  Bounds all;
  for_each_child(nodes[root - first_node], [&](const Child& child) { all.grow(child.bounds); });
  const double area = std::max(all.half_area(), 1e-37f);  // of a root without area
  add_subtree(nodes, first_node, {all, true, root}, area, 1, add_leaf, sum);
  return sum;
}

void add_triangles(const Child& leaf, double area, int, TreeQuality& sum) {
  ++sum.leaves;
  sum.slots += leaf.count;
  sum.triangles_per_ray += area * leaf.count;
}

template <class Node>
TreeQuality measure_two_levels(std::span<const Node> nodes, std::uint32_t first_node,
                               std::span<const InstanceRecord> instances,
                               const QualityByRoot& groups) {
  const auto add_instances = [&](const Child& leaf, double area, int depth, TreeQuality& sum) {
    for (std::uint32_t i = leaf.index; i < leaf.index + leaf.count; ++i) {
      const TreeQuality& group = groups.at(instances[i].root);
      sum.nodes_per_ray += area * group.nodes_per_ray;
      sum.triangles_per_ray += area * group.triangles_per_ray;
      sum.depth = std::max(sum.depth, depth + group.depth);
    }
  };
  TreeQuality sum = measure(nodes, first_node, first_node, add_instances);
  for (const auto& [root, group] : groups) {
    sum.nodes += group.nodes;
    sum.leaves += group.leaves;
    sum.slots += group.slots;
  }
  return sum;
}

}  // namespace

TreeQuality measure_tree(std::span<const Bvh2Node> nodes, std::uint32_t root) {
  return measure(nodes, 0, root, add_triangles);
}
TreeQuality measure_tree(std::span<const CwbvhNode> nodes, std::uint32_t root) {
  return measure(nodes, 0, root, add_triangles);
}

TreeQuality measure_instances(std::span<const Bvh2Node> nodes, std::uint32_t first_node,
                              std::span<const InstanceRecord> instances,
                              const QualityByRoot& groups) {
  return measure_two_levels(nodes, first_node, instances, groups);
}
TreeQuality measure_instances(std::span<const CwbvhNode> nodes, std::uint32_t first_node,
                              std::span<const InstanceRecord> instances,
                              const QualityByRoot& groups) {
  return measure_two_levels(nodes, first_node, instances, groups);
}

namespace {

template <class Node>
TreeQuality measure(const TriangleTreeData& tree, std::span<const Node> nodes) {
  if (tree.instances.empty()) return measure_tree(nodes, tree.root);
  QualityByRoot groups;
  for (const GroupTree& group : tree.groups) {
    groups[group.root] = measure_tree(nodes, group.root);
  }
  return measure_instances(nodes.subspan(tree.first_top_node), tree.first_top_node, tree.instances,
                           groups);
}

}  // namespace

TreeSummary summarize(const TriangleTreeData& tree) {
  TreeSummary summary;
  summary.builder = tree.builder;
  if (!tree.bvh2.empty()) summary.quality = measure(tree, std::span(tree.bvh2));
  if (!tree.cwbvh.empty()) summary.quality = measure(tree, std::span(tree.cwbvh));
  summary.size_bytes = tree.size_bytes();
  summary.build_ms = tree.build_ms;
  return summary;
}

}  // namespace pt
