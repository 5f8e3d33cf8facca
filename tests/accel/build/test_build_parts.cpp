// What the device builders do for one element: codes, prefixes, pairs, collapse.
#include <gtest/gtest.h>

#include <set>

#include "accel/build_cases.h"
#include "common/accel/build/morton_order.h"
#include "common/accel/build/wide/collapse_cwbvh.h"
#include "common/accel/build/wide/wide_children.h"

namespace pt {
namespace {

TEST(Morton, InterleavesTheCellsOfACubicGrid) {
  const MortonGrid grid = make_morton_grid({Vec3(-1), Vec3(1, 0, 0)}, 4);
  EXPECT_EQ(morton_code(grid, Vec3(-1)), 0u);
  EXPECT_EQ(morton_code(grid, Vec3(1, -1, -1)), 0b100100100100u);  // the last cell of x
  EXPECT_EQ(morton_code(grid, Vec3(-1, 0, -1)), 0b010000000000u);  // half of it: cells are cubes
  EXPECT_EQ(morton_code(grid, Vec3(-1, -1, -0.8f)), 0b001u);
  EXPECT_EQ(morton_code(grid, Vec3(9, -9, -9)), 0b100100100100u) << "outside";
  EXPECT_EQ(morton_code(grid, Vec3(NAN)), 0u);
}

TEST(Morton, SpreadsAllBits) {
  TestRandom random(3);
  for (int n = 0; n < 1000; ++n) {
    const std::uint64_t x = random.bits() & 0x1fffffu;
    std::uint64_t expected = 0;
    for (int bit = 0; bit < 21; ++bit) expected |= (x >> bit & 1u) << 3 * bit;
    ASSERT_EQ(spread_bits(x), expected);
  }
}

TEST(Morton, GridsOfAllSizesHoldTheirBox) {
  for (const float size : {0.0f, 1e-44f, 1e-37f, 1e-3f, 1.0f, 1e15f, 3.4e38f}) {
    for (const int bits : {1, 10, 21}) {
      const MortonGrid grid = make_morton_grid({Vec3(-size), Vec3(size)}, bits);
      EXPECT_EQ(morton_code(grid, Vec3(-size)), 0u);
      const std::uint64_t last = morton_code(grid, Vec3(size));
      EXPECT_LT(last, 1ull << 3 * bits);
      if (size > 1e-30f) {
        EXPECT_EQ(last, (1ull << 3 * bits) - 1) << size;
      }
    }
  }
  EXPECT_EQ(morton_code(make_morton_grid({}, 21), Vec3(5)), 0u);
}

// In sorted order, the prefix of two neighbours beats all others within their subtree.
TEST(Morton, PrefixesAreThoseOfTheSortedCodes) {
  TestRandom random(5);
  std::vector<std::uint64_t> codes;
  for (int i = 0; i < 500; ++i) codes.push_back(random.bits() % 64 * 0x123456789ull);
  std::sort(codes.begin(), codes.end());
  for (std::uint32_t i = 0; i + 1 < codes.size(); ++i) {
    int expected = 0;  // as strings of 64 + 32 bits: the code, then the place
    const auto bit = [&](std::uint32_t n, int b) {
      return b < 64 ? codes[n] >> (63 - b) & 1u : n >> (95 - b) & 1u;
    };
    while (bit(i, expected) == bit(i + 1, expected)) ++expected;
    ASSERT_EQ(neighbour_prefix(codes[i], codes[i + 1], i), expected + 1);
  }
}

TEST(PlocPair, BothMembersFindEachOther) {
  const Bounds box{Vec3(0), Vec3(1)};
  for (int distance = 1; distance <= ploc_radius; ++distance) {
    std::set<std::uint32_t> ranks_of_ten;
    for (int lower = 0; lower + distance < 32; ++lower) {
      const std::uint32_t rank = pair_rank(box, box, lower, distance);
      EXPECT_EQ(pair_partner(rank, lower), lower + distance);
      EXPECT_EQ(pair_partner(rank, lower + distance), lower);
      if (lower == 10 || lower + distance == 10) ranks_of_ten.insert(rank);
    }
    EXPECT_EQ(ranks_of_ten.size(), 10 >= distance ? 2u : 1u) << "two pairs of one rank";
  }
}

TEST(PlocPair, SmallerBoxesComeFirstAndStrangeOnesLast) {
  const Bounds unit{Vec3(0), Vec3(1)}, flat{Vec3(0), Vec3(1, 1, 0)};
  const Bounds huge{Vec3(-3e38f), Vec3(3e38f, 0, 0)};
  EXPECT_LT(pair_rank(flat, flat, 0, 8), pair_rank(flat, unit, 0, 1));
  EXPECT_LT(pair_rank(unit, unit, 0, 8), pair_rank(unit, huge, 0, 1));
  EXPECT_LT(pair_rank(huge, huge, 0, 1), no_pair);
  EXPECT_LT(pair_rank({Vec3(NAN), Vec3(NAN)}, unit, 0, 1), no_pair);
}

/// A binary tree over boxes that splits ranges at random.
struct RandomTree {
  std::vector<BuildNode> primitives, nodes;
  std::vector<CollapseTable> tables;
  std::vector<float> binary_costs;
  TreeCosts costs;
  TreeRef root = 0;

  RandomTree(std::uint32_t count, const TreeCosts& with, std::uint64_t seed, double extent = 10)
      : costs(with) {
    TestRandom random(seed);
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec3 p = point_in_cube(random, extent);
      primitives.push_back({p, 0, p + 0.5f + point_in_cube(random, 0.5), 0});
    }
    root = build(random, 0, count);
  }

  TreeRef build(TestRandom& random, std::uint32_t first, std::uint32_t last) {
    if (last - first == 1) return make_ref(1, first);
    const std::uint32_t middle = first + 1 + random.below(last - first - 1);
    const TreeRef left = build(random, first, middle), right = build(random, middle, last);
    const BuildNode a = load_node(view(), left), b = load_node(view(), right);
    Bounds box = a.bounds();
    box.grow(b.bounds());
    const auto place = static_cast<std::uint32_t>(nodes.size());
    tables.push_back(join_tables(costs, load_table(view(), costs, left),
                                 load_table(view(), costs, right), box.half_area(), last - first));
    const auto cost_of = [&](TreeRef ref, const BuildNode& node) {
      return is_primitive(ref) ? binary_leaf_cost(costs, node.bounds().half_area(), 1)
                               : binary_costs[ref_index(ref)];
    };
    binary_costs.push_back(
        binary_cost(costs, cost_of(left, a), cost_of(right, b), box.half_area(), last - first));
    nodes.push_back({box.min, left, box.max, right});
    return make_ref(last - first, place);
  }

  BuildTree view() const { return {primitives.data(), nodes.data(), tables.data(), nullptr}; }
};

/// The cost of the wide tree below an inner child.
template <class Choose>
double wide_cost(const RandomTree& tree, TreeRef ref, const Choose& choose,
                 std::vector<int>& seen) {
  const BuildTree view = tree.view();
  double cost = load_node(view, ref).bounds().half_area() * tree.costs.node;
  const WideChildren children = choose(ref);
  EXPECT_GE(children.count, 1);
  EXPECT_LE(children.count, cwbvh_width);
  for (int i = 0; i < children.count; ++i) {
    const TreeRef child = children.ref[i];
    if ((children.leaf_mask >> i & 1) == 0) {
      cost += wide_cost(tree, child, choose, seen);
      continue;
    }
    EXPECT_LE(ref_count(child), tree.costs.leaf_max);
    for_each_primitive(view, child, [&](std::uint32_t p) { ++seen[p]; });
    cost += load_node(view, child).bounds().half_area() * tree.costs.triangle;  // as one
  }
  return cost;
}

TEST(WideChildren, EveryPrimitiveOnceAndTheOptimalCostIsTheTables) {
  for (const std::uint32_t leaf_max : {1u, 2u, 3u}) {
    for (const std::uint32_t count : {2u, 3u, 4u, 9u, 30u, 500u}) {
      const RandomTree tree(count, {1.0f, 0.3f, leaf_max}, count);
      const BuildTree view = tree.view();
      std::vector<int> seen(count);
      const double optimum = wide_cost(
          tree, tree.root, [&](TreeRef r) { return optimal_children(view, tree.costs, r); }, seen);
      EXPECT_EQ(seen, std::vector<int>(count, 1));
      if (count > leaf_max) {
        EXPECT_NEAR(optimum, tree.tables[ref_index(tree.root)].cost[0], 1e-4 * optimum);
      }
    }
  }
}

// The same dynamic programming as the CPU builder's, written independently.
TEST(WideChildren, OptimumIsTheCpuBuilders) {
  const RandomTree tree(400, {1.0f, 0.3f, 3}, 1);
  BinaryTree binary;
  binary.node_capacity = static_cast<std::uint32_t>(tree.nodes.size());
  binary.nodes = std::make_unique<Bvh2Node[]>(tree.nodes.size());
  binary.bounds = load_node(tree.view(), tree.root).bounds();
  const auto copy = [&](const auto& self, TreeRef ref, std::uint32_t& next) -> std::uint32_t {
    if (is_primitive(ref)) {
      binary.order.push_back(ref_index(ref));
      return make_leaf(static_cast<std::uint32_t>(binary.order.size() - 1), 1);
    }
    const std::uint32_t place = next++;
    const BuildNode& node = tree.nodes[ref_index(ref)];
    set_child_bounds(binary.nodes[place], 0, load_node(tree.view(), node.left).bounds());
    set_child_bounds(binary.nodes[place], 1, load_node(tree.view(), node.right).bounds());
    binary.nodes[place].child[0] = self(self, node.left, next);
    binary.nodes[place].child[1] = self(self, node.right, next);
    return place;
  };
  std::uint32_t next = 0;
  binary.root = copy(copy, tree.root, next);
  const Cwbvh reference = collapse_cwbvh(binary, tree.costs);
  std::size_t nodes = 0;
  const auto count = [&](const auto& self, TreeRef ref) -> void {
    ++nodes;
    const WideChildren children = optimal_children(tree.view(), tree.costs, ref);
    for (int i = 0; i < children.count; ++i) {
      if ((children.leaf_mask >> i & 1) == 0) self(self, children.ref[i]);
    }
  };
  count(count, tree.root);
  EXPECT_EQ(nodes, reference.nodes.size());
}

// Leaves as the CPU builder's are: by an independent recursion over all choices.
TEST(BinaryLeaf, IsALeafWhereThatIsCheaper) {
  const auto visit = [](const auto& self, const RandomTree& t, TreeRef ref,
                        auto&& check) -> double {
    const BuildNode node = load_node(t.view(), ref);
    const float area = node.bounds().half_area();
    const double leaf = ref_count(ref) <= t.costs.leaf_max
                            ? double(area) * ref_count(ref) * double(t.costs.triangle)
                            : 1e30;
    if (is_primitive(ref)) return leaf;
    const double inner = double(area) * double(t.costs.node) + self(self, t, node.left, check) +
                         self(self, t, node.right, check);
    if (std::abs(leaf / inner - 1) > 1e-5) check(ref, area, leaf < inner);
    return std::min(leaf, inner);
  };
  int leaves = 0, others = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    RandomTree tree(2 + seed % 40, {1.0f, 0.7f, 8}, seed, 0.3);
    BuildTree view = tree.view();
    view.binary_costs = tree.binary_costs.data();
    visit(visit, tree, tree.root, [&](TreeRef ref, float area, bool expected) {
      EXPECT_EQ(is_binary_leaf(view, tree.costs, ref, area), expected);
      (expected ? leaves : others) += 1;
    });
  }
  EXPECT_GT(leaves, 200);
  EXPECT_GT(others, 200);
}

}  // namespace
}  // namespace pt
