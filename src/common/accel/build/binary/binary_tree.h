// The binary tree that the CPU's builders make first, down to single triangles, and the costs of
// traversal. Leaves of several triangles are chosen afterwards, by cost (build_bvh2.h,
// collapse_cwbvh.h).
#pragma once

#include <algorithm>
#include <array>
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

/// The costs of traversal, in any unit: the builders choose leaves so that the expected sum along a
/// random ray is least.
struct TreeCosts {
  float node = 1.0f;      ///< for visiting a node, that is testing all of its children
  float triangle = 1.0f;  ///< for testing a triangle
  std::uint32_t leaf_max = leaf_size_max;
};

/// A point so far away that no ray gets there: the box of a child that traversal skips.
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

/// The cost of testing the one or two triangles of a wide tree's leaf, relative to the eight boxes
/// of a node.
inline constexpr float cwbvh_triangle_cost = 0.5f;

inline constexpr TreeCosts default_bvh2_costs = {1.0f, 1.0f, 4};
inline constexpr TreeCosts default_cwbvh_costs = {1.0f, cwbvh_triangle_cost, cwbvh_leaf_max};

/// The primitives below a node, as long as they are few enough for a leaf: a set of at most
/// leaf_size_max, each once however often spatial splits repeat it.
class LeafMembers {
 public:
  void add(std::uint32_t primitive) {
    if (size_ > leaf_size_max || std::find(begin(), end(), primitive) != end()) return;
    if (size_ < leaf_size_max) ids_[size_] = primitive;
    ++size_;  // beyond leaf_size_max: too many
  }
  void add(const LeafMembers& others) {
    if (others.size_ > leaf_size_max) size_ = leaf_size_max + 1;
    for (const std::uint32_t primitive : others) add(primitive);
  }
  /// More than leaf_size_max: the members are not known.
  std::uint32_t size() const { return size_; }
  const std::uint32_t* begin() const { return ids_.data(); }
  const std::uint32_t* end() const { return ids_.data() + std::min(size_, leaf_size_max); }

 private:
  std::uint32_t size_ = 0;
  std::array<std::uint32_t, leaf_size_max> ids_;
};

}  // namespace pt
