#include "common/accel/build/tree_summary.h"

namespace pt {
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
