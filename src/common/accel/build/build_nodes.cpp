#include "common/accel/build/build_nodes.h"

#include <tbb/parallel_for.h>

#include "common/accel/build/binary/build_bvh2.h"
#include "common/accel/build/wide/collapse_cwbvh.h"

namespace pt {

namespace {

void move_references(Bvh2Node& node, std::uint32_t nodes, std::uint32_t slots) {
  for (std::uint32_t& child : node.child) child += is_leaf(child) ? slots : nodes;
}

void move_references(CwbvhNode& node, std::uint32_t nodes, std::uint32_t slots) {
  node.child_base += nodes;
  node.triangle_base += slots;
}

}  // namespace

std::uint32_t BuiltNodes::node_count() const {
  std::size_t count = 0;
  for_each_nodes([&](const auto& nodes) { count += nodes.size(); });
  return static_cast<std::uint32_t>(count);
}

bool has_nodes(AccelKind accel) { return accel == AccelKind::bvh2 || accel == AccelKind::cwbvh; }

BuiltNodes build_nodes(BinaryTree&& binary, AccelKind accel, const TreeCosts& costs) {
  BuiltNodes built;
  if (accel == AccelKind::bvh2) {
    Bvh2 tree = merge_leaves(std::move(binary), costs);
    built.bvh2 = std::move(tree.nodes), built.order = std::move(tree.order);
  } else {
    Cwbvh tree = collapse_cwbvh(binary, costs);
    built.cwbvh = std::move(tree.nodes), built.order = std::move(tree.order);
  }
  return built;
}

void move_references(TreeNodes<NodesVector>& tree, std::uint32_t nodes, std::uint32_t slots) {
  if (nodes == 0 && slots == 0) return;
  tree.for_each_nodes(tree, [&](auto& array, auto&) {
    tbb::parallel_for(std::size_t{0}, array.size(),
                      [&](std::size_t i) { move_references(array[i], nodes, slots); });
  });
}

std::uint32_t append_nodes(TreeNodes<NodesVector>& all, TreeNodes<NodesVector>&& tree,
                           std::uint32_t first_slot) {
  std::uint32_t root = 0;
  all.for_each_nodes([&](const auto& nodes) { root += static_cast<std::uint32_t>(nodes.size()); });
  move_references(tree, root, first_slot);
  all.for_each_nodes(tree, [](auto& to, auto& nodes) {
    if (to.empty()) {
      to = std::move(nodes);
    } else {
      to.insert(to.end(), nodes.begin(), nodes.end());
    }
  });
  return root;
}

}  // namespace pt
