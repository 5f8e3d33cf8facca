#include "common/accel/build/build_nodes.h"

#include "common/accel/build/binary/merge_leaves.h"
#include "common/accel/build/wide/collapse_cwbvh.h"

namespace pt {

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

}  // namespace pt
