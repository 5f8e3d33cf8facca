// Reinsertion keeps the leaves, makes trees cheaper, and keeps what is asked of a BinaryTree.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstring>
#include <numeric>

#include "accel/triangle_meshes.h"
#include "common/accel/build/binary/build_binary.h"
#include "common/accel/build/mesh_triangles.h"

namespace pt {
namespace {

BinaryTree sah_tree(const Mesh& mesh) {
  const MeshTriangles triangles({&mesh, 1});
  return build_sah(triangles.count(), [&](std::uint32_t i) { return triangles.bounds(i); });
}

/// A balanced tree over triangles in the order of their numbers.
class TreeByNumber {
 public:
  explicit TreeByNumber(const Mesh& mesh) : triangles_({&mesh, 1}) {
    tree.node_capacity = triangles_.count();
    tree.nodes.reset(new Bvh2Node[triangles_.count()]());
    tree.order.resize(triangles_.count());
    std::iota(tree.order.begin(), tree.order.end(), 0u);
    tree.root = add(0, triangles_.count(), tree.bounds);
  }

  BinaryTree tree;

 private:
  std::uint32_t add(std::uint32_t first, std::uint32_t end, Bounds& box) {
    if (end - first == 1) {
      box = triangles_.bounds(first);
      return make_leaf(first, 1);
    }
    const std::uint32_t index = count_++, middle = (first + end) / 2;
    Bounds half[2];
    tree.nodes[index].child[0] = add(first, middle, half[0]);
    tree.nodes[index].child[1] = add(middle, end, half[1]);
    for (int i = 0; i < 2; ++i) {
      set_child_bounds(tree.nodes[index], i, half[i]);
      box.grow(half[i]);
    }
    return index;
  }

  MeshTriangles triangles_;
  std::uint32_t count_ = 0;
};

/// What a walk through a tree finds; boxes of nodes must be those of what is below, exactly.
struct Walk {
  explicit Walk(const BinaryTree& tree) : tree_(tree) {
    leaves.resize(tree.order.size());
    visit(tree.root, tree.bounds, 0);
  }

  std::vector<Bounds> leaves;  ///< by place
  std::uint32_t leaf_count = 0;
  double area = 0;  ///< of all nodes, relative to the root
  int depth = 0;

 private:
  void visit(std::uint32_t child, const Bounds& box, int level) {
    if (is_leaf(child)) {
      EXPECT_EQ(child, make_leaf(leaf_first(child), 1));
      EXPECT_TRUE(leaves.at(leaf_first(child)).is_empty()) << "twice";
      leaves[leaf_first(child)] = box;
      ++leaf_count;
      return;
    }
    depth = std::max(depth, level + 1);
    area += static_cast<double>(box.half_area()) / static_cast<double>(tree_.bounds.half_area());
    ASSERT_LT(child, tree_.node_capacity);
    const Bvh2Node& node = tree_.nodes[child];
    EXPECT_TRUE(is_leaf(node.child[0]) || node.child[0] > child);
    EXPECT_TRUE(is_leaf(node.child[1]) || node.child[1] > child);
    if (!is_leaf(node.child[0]) && !is_leaf(node.child[1])) {
      EXPECT_LT(node.child[0], node.child[1]);
    }
    Bounds both = child_bounds(node, 0);
    both.grow(child_bounds(node, 1));
    EXPECT_EQ(both.min, box.min);
    EXPECT_EQ(both.max, box.max);
    for (int i = 0; i < 2; ++i) visit(node.child[i], child_bounds(node, i), level + 1);
  }

  const BinaryTree& tree_;
};

/// Returns whether there is a new tree.
bool check(const BinaryTree& before) {
  const std::optional<BinaryTree> result = reinsert_nodes(before);
  if (!result) return false;
  const BinaryTree& after = *result;
  const Walk old(before), now(after);
  EXPECT_EQ(after.order, before.order);
  EXPECT_EQ(after.bounds.min, before.bounds.min);
  EXPECT_EQ(after.bounds.max, before.bounds.max);
  EXPECT_EQ(now.leaf_count, before.order.size());
  for (std::size_t i = 0; i < now.leaves.size(); ++i) {
    EXPECT_EQ(now.leaves[i].min, old.leaves[i].min);
    EXPECT_EQ(now.leaves[i].max, old.leaves[i].max);
  }
  EXPECT_LE(now.depth, bvh_depth_max);
  EXPECT_LT(now.area, old.area);
  return true;
}

TEST(ReinsertNodes, KeepsTheLeavesAndTheOrder) {
  int changed = 0;
  for (const MeshKind& kind : mesh_kinds) {
    for (const int count : {1, 2, 3, 10, 100, 3000}) {
      SCOPED_TRACE(testing::Message() << kind.name << ", " << count);
      const Mesh mesh = kind.make(count);
      changed += check(sah_tree(mesh)) ? 1 : 0;
      changed += check(TreeByNumber(mesh).tree) ? 1 : 0;
      if (HasFailure()) return;
    }
  }
  EXPECT_GT(changed, 10);
}

// Two subtrees, each with half of two clusters far apart: of all nodes those with the largest boxes
// are wrong.
TEST(ReinsertNodes, PutsAClusterTogether) {
  Mesh mesh;
  for (int part = 0; part < 4; ++part) {
    const Mesh cluster = make_soup(16, 0.1, Vec3(part % 2 ? 1000.0f : 0.0f), 1 + part);
    for (const TriangleIndices& t : cluster.triangles) {
      add_triangle(mesh, cluster.positions[t.v[0]], cluster.positions[t.v[1]],
                   cluster.positions[t.v[2]]);
    }
  }
  const BinaryTree before = TreeByNumber(mesh).tree;
  // Three boxes of about the root's size become one.
  EXPECT_GT(Walk(before).area, 3);
  const std::optional<BinaryTree> after = reinsert_nodes(before);
  ASSERT_TRUE(after);
  EXPECT_LT(Walk(*after).area, 1.1);
}

TEST(ReinsertNodes, TreesStayAsShallowAsTraversalsExpect) {
  const Mesh mesh = make_geometric_series(140);
  check(sah_tree(mesh));
  check(TreeByNumber(mesh).tree);
}

/// A list of `nodes` nodes, each leaf half as far away as the one before and half as large; beside
/// it something far away. In the root's other half there are two leaves close to the list, and
/// beside them something as far away on the other side.
BinaryTree list_and_pair(int nodes) {
  const auto cube = [](float x, float size) { return Bounds{Vec3(x), Vec3(x + size)}; };
  BinaryTree tree;
  tree.node_capacity = static_cast<std::uint32_t>(nodes) + 4;
  tree.nodes.reset(new Bvh2Node[tree.node_capacity]());
  std::uint32_t count = 0, leaves = 0;
  const auto set = [&](std::uint32_t node, int i, std::uint32_t child, const Bounds& box) {
    tree.nodes[node].child[i] = child;
    set_child_bounds(tree.nodes[node], i, box);
  };
  const std::uint32_t root = count++, left = count++;
  const Bounds far = cube(1000, 1), list = {Vec3(0), Vec3(1.5f)}, pair = {Vec3(2), Vec3(4)};
  const Bounds below = cube(-1000, 1);
  const auto joined = [](Bounds a, const Bounds& b) { return a.grow(b), a; };
  set(root, 0, left, joined(list, far));
  set(left, 0, count, list);
  for (int i = 0; i < nodes; ++i) {
    const std::uint32_t node = count++;
    const float s = std::ldexp(1.0f, -i);
    const bool is_last = i + 1 == nodes;
    set(node, 0, is_last ? make_leaf(leaves, 1) : count, {Vec3(0), Vec3(0.75f * s)});
    leaves += is_last ? 1 : 0;
    set(node, 1, make_leaf(leaves++, 1), cube(s, 0.5f * s));
  }
  set(left, 1, make_leaf(leaves++, 1), far);
  const std::uint32_t right = count++, both = count++;
  set(root, 1, right, joined(pair, below));
  set(right, 0, both, pair);
  set(both, 0, make_leaf(leaves++, 1), cube(2, 1)),
      set(both, 1, make_leaf(leaves++, 1), cube(3, 1));
  set(right, 1, make_leaf(leaves++, 1), below);
  tree.order.resize(leaves);
  std::iota(tree.order.begin(), tree.order.end(), 0u);
  tree.bounds = joined(below, far);
  return tree;
}

// The list belongs to the pair, one level further down.
TEST(ReinsertNodes, WhatWouldGetTooDeepStays) {
  const BinaryTree shallow = list_and_pair(bvh_depth_max - 3);
  EXPECT_EQ(Walk(shallow).depth, bvh_depth_max - 1);
  const std::optional<BinaryTree> moved = reinsert_nodes(shallow);
  ASSERT_TRUE(moved);
  EXPECT_EQ(Walk(*moved).depth, bvh_depth_max);
  const BinaryTree deep = list_and_pair(bvh_depth_max - 2);
  EXPECT_EQ(Walk(deep).depth, bvh_depth_max);
  EXPECT_FALSE(reinsert_nodes(deep));
}

TEST(ReinsertNodes, ThreadsDoNotChangeTheTree) {
  const TreeByNumber before(make_soup(20'000, 1));
  const auto nodes = [&](std::size_t threads) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const BinaryTree tree = reinsert_nodes(before.tree).value();
    return std::string(reinterpret_cast<const char*>(tree.nodes.get()),
                       (tree.order.size() - 1) * sizeof(Bvh2Node));
  };
  EXPECT_TRUE(nodes(1) == nodes(3));
}

}  // namespace
}  // namespace pt
