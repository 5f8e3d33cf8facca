// What the CPU's builders make first: a binary tree down to single triangles. Leaves of several
// triangles are chosen afterwards, by cost (merge_leaves.h, collapse_cwbvh.h).
#pragma once

#include <memory>
#include <vector>

#include "common/accel/nodes.h"
#include "common/geometry/bounds.h"

namespace pt {

/// Primitives that a tree can hold: leaf_first has 28 bits.
inline constexpr std::uint32_t build_primitives_max = 1u << 28;

/// Boxes are those of the primitives (of triangles hit_bounds), or of the parts that a spatial
/// split cut off, or contain such. A leaf is one element of `order`. Nodes lie in depth-first
/// order, so that those below a node follow it, the first child's before the second's; there may be
/// unused ones in between.
struct BinaryTree {
  std::unique_ptr<Bvh2Node[]> nodes;
  std::uint32_t node_capacity = 0;   ///< size of `nodes`
  std::vector<std::uint32_t> order;  ///< leaf index -> primitive
  std::uint32_t root = 0;            ///< a node, or the leaf of the only primitive
  Bounds bounds;                     ///< of the root
};

/// What traversal pays, in any unit: the builders choose leaves so that the expected sum along a
/// random ray is least.
struct TreeCosts {
  float node = 1.0f;      ///< for visiting a node, that is testing all of its children
  float triangle = 1.0f;  ///< for testing a triangle
  std::uint32_t leaf_max = leaf_size_max;
};

/// A point so far away that no ray gets there: the box of a child that is to be passed over.
PT_HD Bounds unreachable_bounds() { return {Vec3(1e30f), Vec3(1e30f)}; }

PT_HD void set_child_bounds(Bvh2Node& node, int child, const Bounds& box) {
  node.xy[child] = {box.min.x, box.max.x, box.min.y, box.max.y};
  node.z[2 * child] = box.min.z;
  node.z[2 * child + 1] = box.max.z;
}

PT_HD Bounds child_bounds(const Bvh2Node& node, int child) {
  const Vec4& xy = node.xy[child];
  return {{xy.x, xy.z, node.z[2 * child]}, {xy.y, xy.w, node.z[2 * child + 1]}};
}

}  // namespace pt
