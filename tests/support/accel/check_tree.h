// Walks a tree and collects what must hold of every tree.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "common/accel/build/triangle_tree_data.h"

namespace pt {

/// Exact: floats, and sums of 8 bits times 16 bits and a float, fit into doubles but for scales
/// that are far apart.
struct ExactBox {
  glm::dvec3 min{-HUGE_VAL}, max{HUGE_VAL};

  bool contains(const glm::dvec3& p) const {
    return glm::all(glm::lessThanEqual(min, p)) && glm::all(glm::lessThanEqual(p, max));
  }
  ExactBox intersection(const ExactBox& b) const {
    return {glm::max(min, b.min), glm::min(max, b.max)};
  }
};

/// With the tolerance that traversal adds.
inline ExactBox exact_child_box(const CwbvhNode& node, int slot) {
  ExactBox box;
  for (int i = 0; i < 3; ++i) {
    const double step = node.step(i), slack = step * cwbvh_grid_tolerance;
    box.min[i] = node.origin[i] + step * node.planes[i][2 * slot] - slack;
    box.max[i] = node.origin[i] + step * node.planes[i][2 * slot + 1] + slack;
  }
  return box;
}

/// A leaf's slots, with the intersection of all boxes from the root down: where rays find it.
struct LeafPlace {
  std::uint32_t first, count;
  ExactBox box;
};

class TreeWalk {
 public:
  explicit TreeWalk(const TriangleTreeData& tree) : tree_(tree) {}

  /// Below `root`, an absolute place among the nodes.
  void walk(std::uint32_t root) {
    if (tree_.cwbvh.empty()) {
      walk_binary(root, {}, 1);
    } else {
      walk_wide(root, {}, 1);
    }
  }

  std::vector<LeafPlace> leaves;
  std::vector<int> node_visits;  // by node
  int depth = 0;

 private:
  void visit(std::uint32_t node, std::size_t count, int level) {
    node_visits.resize(count);
    ++node_visits.at(node);
    depth = std::max(depth, level);
  }

  void walk_binary(std::uint32_t index, const ExactBox& box, int level) {
    visit(index, tree_.bvh2.size(), level);
    const Bvh2Node& node = tree_.bvh2[index];
    for (int i = 0; i < 2; ++i) {
      const Vec4& xy = node.xy[i];
      if (xy.x == 1e30f) continue;  // the second child of a tree that is one leaf
      const ExactBox own{{xy.x, xy.z, node.z[2 * i]}, {xy.y, xy.w, node.z[2 * i + 1]}};
      const ExactBox child = box.intersection(own);
      const std::uint32_t code = node.child[i];
      if (is_leaf(code)) {
        leaves.push_back({leaf_first(code), leaf_count(code), child});
      } else {
        walk_binary(code, child, level + 1);
      }
    }
  }

  void walk_wide(std::uint32_t index, const ExactBox& box, int level) {
    visit(index, tree_.cwbvh.size(), level);
    const CwbvhNode& node = tree_.cwbvh[index];
    std::uint32_t inner = node.child_base, slot = node.triangle_base;
    for_each_cwbvh_child(node, [&](int s, const CwbvhChild& child) {
      const ExactBox inside = box.intersection(exact_child_box(node, s));
      if (child.count == 0) {
        EXPECT_EQ(child.index, inner++);
        return walk_wide(child.index, inside, level + 1);
      }
      EXPECT_EQ(child.index, slot) << "leaves are not contiguous";
      leaves.push_back({slot, child.count, inside});
      slot += child.count;
    });
  }

  const TriangleTreeData& tree_;
};

}  // namespace pt
