// Leaves and wide nodes are chosen at the least cost, found here by trying everything; clipped
// boxes hold the triangle's part.
#include <gtest/gtest.h>

#include "accel/triangle_meshes.h"
#include "common/accel/build/binary/build_binary.h"
#include "common/accel/build/binary/build_bvh2.h"
#include "common/accel/build/binary/split.h"
#include "common/accel/build/mesh_triangles.h"
#include "common/accel/build/tree_statistics.h"
#include "common/accel/build/wide/collapse_cwbvh.h"

namespace pt {
namespace {

BinaryTree binary_tree(const Mesh& mesh) {
  const MeshTriangles triangles({&mesh, 1});
  return build_sah(triangles.count(), [&](std::uint32_t i) { return triangles.bounds(i); });
}

/// The definitions, by recursion without tables.
class Exhaustive {
 public:
  Exhaustive(const BinaryTree& tree, const TreeCosts& costs) : tree_(tree), costs_(costs) {}

  /// A forest of at most `roots` wide trees over a subtree.
  double wide(std::uint32_t child, double area, int roots) const {
    // The triangles of a leaf are tested together.
    const std::uint32_t most = std::min<std::uint32_t>(costs_.leaf_max, cwbvh_leaf_max);
    double best = count(child) > most ? HUGE_VAL : costs_.triangle * area;
    if (is_leaf(child)) return best;
    best = std::min(best, wide_node(child, area));
    for (int i = 2; i <= roots; ++i) best = std::min(best, shared(child, i));
    return best;
  }
  double wide_node(std::uint32_t child, double area) const {
    return costs_.node * area + shared(child, 8);
  }
  double binary(std::uint32_t child, double area) const {
    const std::uint32_t n = count(child);
    const double whole = n > costs_.leaf_max ? HUGE_VAL : costs_.triangle * area * n;
    if (is_leaf(child)) return whole;
    const Bvh2Node& node = tree_.nodes[child];
    return std::min(whole, costs_.node * area + binary(node.child[0], area_of(node, 0)) +
                               binary(node.child[1], area_of(node, 1)));
  }

 private:
  static double area_of(const Bvh2Node& node, int i) { return child_bounds(node, i).half_area(); }
  std::uint32_t count(std::uint32_t child) const {
    if (is_leaf(child)) return 1;
    const Bvh2Node& node = tree_.nodes[child];
    return count(node.child[0]) + count(node.child[1]);
  }
  double shared(std::uint32_t child, int roots) const {
    const Bvh2Node& node = tree_.nodes[child];
    double best = HUGE_VAL;
    for (int i = 1; i < roots; ++i) {
      best = std::min(best, wide(node.child[0], area_of(node, 0), i) +
                                wide(node.child[1], area_of(node, 1), roots - i));
    }
    return best;
  }

  const BinaryTree& tree_;
  TreeCosts costs_;
};

/// The cost of the wide tree that the choices describe, with the binary tree's boxes.
double chosen_cost(const CollapseChoices& choices, const TreeCosts& costs, std::uint32_t index,
                   double area) {
  double sum = costs.node * area;
  const CollapsedChildren children = choices.children_of(index);
  for (int c = 0; c < children.count; ++c) {
    const CollapsedChild& child = children.child[c];
    const double child_area = child.bounds.half_area();
    sum += child.is_inner ? chosen_cost(choices, costs, child.subtree, child_area)
                          : costs.triangle * child_area;
  }
  return sum;
}

TEST(Collapse, FindsTheCheapestWideTree) {
  for (const float triangle_cost : {0.1f, 0.3f, 1.0f, 5.0f}) {
    for (int count = 2; count <= 14; ++count) {
      SCOPED_TRACE(testing::Message() << count << " triangles of cost " << triangle_cost);
      const TreeCosts costs = {1, triangle_cost, cwbvh_leaf_max};
      const BinaryTree tree = binary_tree(make_soup(count, 5));
      const double area = tree.bounds.half_area();
      const double best = Exhaustive(tree, costs).wide_node(tree.root, area);
      const CollapseChoices choices(tree, costs);
      EXPECT_NEAR(chosen_cost(choices, costs, tree.root, area), best, 1e-5 * best);
    }
  }
}

double binary_cost(const Bvh2& tree, const TreeCosts& costs, std::uint32_t child, double area) {
  if (is_leaf(child)) return costs.triangle * area * leaf_count(child);
  const Bvh2Node& node = tree.nodes[child];
  double sum = costs.node * area;
  for (int i = 0; i < 2; ++i) {
    sum += binary_cost(tree, costs, node.child[i], child_bounds(node, i).half_area());
  }
  return sum;
}

TEST(Collapse, FindsTheCheapestLeaves) {
  for (const TreeCosts& costs : {TreeCosts{1, 1, 4}, TreeCosts{1, 0.2f, 8}, TreeCosts{1, 9, 8}}) {
    const BinaryTree tree = binary_tree(make_soup(300, 5));
    const double area = tree.bounds.half_area();
    const double best = Exhaustive(tree, costs).binary(tree.root, area);
    const Bvh2 merged = merge_leaves(binary_tree(make_soup(300, 5)), costs);
    EXPECT_NEAR(binary_cost(merged, costs, 0, area), best, 1e-4 * best);
  }
}

TEST(Collapse, BeatsLeavesOfOneTriangle) {
  const BinaryTree tree = binary_tree(make_closed_sphere(40));
  const Cwbvh leaves_of_one = collapse_cwbvh(tree, {1, 0.3f, 1});
  const Cwbvh cheapest = collapse_cwbvh(tree, {1, 0.3f, 3});
  EXPECT_LT(measure_tree(cheapest.nodes, 0).sah_cost(0.3),
            measure_tree(leaves_of_one.nodes, 0).sah_cost(0.3));
  EXPECT_LT(cheapest.nodes.size(), leaves_of_one.nodes.size());
}

bool contains(const Bounds& box, const glm::dvec3& p) {
  return glm::all(glm::lessThanEqual(glm::dvec3(box.min), p)) &&
         glm::all(glm::greaterThanEqual(glm::dvec3(box.max), p));
}

/// Points inside of a box and of a triangle, and their box.
struct PartSamples {
  std::vector<glm::dvec3> points;
  glm::dvec3 low{HUGE_VAL}, high{-HUGE_VAL};

  PartSamples(const Vec3 (&v)[3], const Bounds& box) {
    constexpr int n = 60;
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; i + j <= n; ++j) {
        const double a = 1.0 * i / n, b = 1.0 * j / n;
        const glm::dvec3 p =
            a * glm::dvec3(v[0]) + b * glm::dvec3(v[1]) + (1 - a - b) * glm::dvec3(v[2]);
        if (!contains(box, p)) continue;
        points.push_back(p);
        low = glm::min(low, p), high = glm::max(high, p);
      }
    }
  }
};

TEST(ClipTriangle, KeepsThePartAndLittleMore) {
  TestRandom random(2);
  for (const float scale : {1e-3f, 1.0f, 1e4f}) {
    for (int i = 0; i < 300; ++i) {
      const Vec3 at = i % 2 ? Vec3(0.0f) : 100.0f * scale * Vec3(1, -1, 1);
      const auto point = [&] { return at + scale * point_in_cube(random, 1); };
      Vec3 v[3] = {point(), point(), point()};
      if (i % 5 == 0) v[0].z = v[1].z = v[2].z;
      Bounds box;
      box.grow(point()), box.grow(point());
      const Bounds part = clipped_bounds(v, box);
      const PartSamples samples(v, box);
      for (const glm::dvec3& p : samples.points) ASSERT_TRUE(contains(part, p));
      if (part.is_empty()) continue;
      ASSERT_TRUE(contains(box, part.min) && contains(box, part.max));
      if (samples.points.empty()) continue;
      const double step = 3.0 * scale / 30;  // the grid may miss so much of the part
      for (int axis = 0; axis < 3; ++axis) {
        ASSERT_LT(samples.low[axis] - part.min[axis], step);
        ASSERT_LT(part.max[axis] - samples.high[axis], step);
      }
    }
  }
}

TEST(ClipTriangle, ToleratesABoxThatRoundingHasMovedAway) {
  const Vec3 v[3] = {{0, 0, 1}, {100, 0, 1}, {0, 100, 1}};
  const float above = std::nextafter(1.0f, 2.0f);
  EXPECT_FALSE(clipped_bounds(v, {{0, 0, above}, {1, 1, 2}}).is_empty());
  EXPECT_TRUE(clipped_bounds(v, {{0, 0, 1.01f}, {1, 1, 2}}).is_empty());
  EXPECT_TRUE(clipped_bounds(v, {{60, 60, 0}, {70, 70, 2}}).is_empty()) << "beside the long edge";
}

struct Quality {
  TreeQuality sah, sbvh;
};

Quality compare_builders(const Mesh& mesh, const SbvhOptions& options = {}) {
  const MeshTriangles triangles({&mesh, 1});
  const TreeCosts costs = {1, 1, 4};
  const Bvh2 sah = merge_leaves(binary_tree(mesh), costs);
  const Bvh2 sbvh =
      merge_leaves(build_sbvh(
                       triangles.count(), [&](std::uint32_t i) { return triangles[i]; }, options),
                   costs);
  return {measure_tree(sah.nodes, 0), measure_tree(sbvh.nodes, 0)};
}

TEST(SpatialSplits, PayForSlantedNeedlesAndStayWithinTheBudget) {
  double last = HUGE_VAL;
  for (const float budget : {1.0f, 8.0f, 30.0f}) {
    const Quality quality = compare_builders(make_slanted(1000), {1e-5f, budget});
    const double cost = quality.sbvh.sah_cost(1);
    EXPECT_LT(cost, 0.9 * quality.sah.sah_cost(1));
    EXPECT_LT(cost, 0.9 * last);
    EXPECT_GT(quality.sbvh.slots, 1000u);
    EXPECT_LE(static_cast<float>(quality.sbvh.slots), 1000 * (1 + budget));
    last = cost;
  }
}

TEST(SpatialSplits, AreNotMadeWhereTheyDoNotPay) {
  for (const Mesh& mesh : {make_flat_grid(40), make_closed_sphere(30)}) {
    const Quality quality = compare_builders(mesh);
    EXPECT_LE(quality.sbvh.sah_cost(1), 1.001 * quality.sah.sah_cost(1));
    EXPECT_LE(quality.sbvh.slots, mesh.triangles.size() * 11 / 10);
  }
}

}  // namespace
}  // namespace pt
