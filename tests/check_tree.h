// Walks a tree and collects what must hold of every tree.
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <vector>

#include "common/accel/triangle_tree_data.h"

namespace pt {

/// Exact: floats, and sums of 8 bits times a power of two and a float, fit into doubles.
struct ExactBox {
  glm::dvec3 min{-HUGE_VAL}, max{HUGE_VAL};

  bool contains(const glm::dvec3& p) const {
    return glm::all(glm::lessThanEqual(min, p)) && glm::all(glm::lessThanEqual(p, max));
  }
  ExactBox intersection(const ExactBox& b) const {
    return {glm::max(min, b.min), glm::min(max, b.max)};
  }
};

inline ExactBox exact_child_box(const CwbvhNode& node, int slot) {
  const int low[3] = {node.low_x[slot], node.low_y[slot], node.low_z[slot]};
  const int high[3] = {node.high_x[slot], node.high_y[slot], node.high_z[slot]};
  ExactBox box;
  for (int i = 0; i < 3; ++i) {
    box.min[i] = node.origin[i] + std::ldexp(low[i], node.exponent[i] - 127);
    box.max[i] = node.origin[i] + std::ldexp(high[i], node.exponent[i] - 127);
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
    for (int s = 0; s < 8; ++s) {
      if (node.meta[s] == 0) continue;
      const ExactBox child = box.intersection(exact_child_box(node, s));
      if ((node.inner_mask >> s & 1) != 0) {
        walk_wide(inner++, child, level + 1);
        continue;
      }
      const auto count =
          static_cast<std::uint32_t>(std::popcount(static_cast<unsigned>(node.meta[s]) >> 5));
      EXPECT_EQ(node.triangle_base + (node.meta[s] & 31u), slot) << "leaves are not contiguous";
      leaves.push_back({slot, count, child});
      slot += count;
    }
  }

  const TriangleTreeData& tree_;
};

}  // namespace pt
