// Wide nodes: no box loses more than the tolerance to quantisation, flat children lie on the grid,
// slots go from near to far, and the masks say what the children are.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "accel/check_tree.h"
#include "accel/triangle_meshes.h"
#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/build/wide/encode_cwbvh.h"
#include "common/geometry/triangle.h"

namespace pt {
namespace {

CwbvhChildren random_children(TestRandom& random, float offset, float extent) {
  CwbvhChildren children;
  children.count = static_cast<int>(random.below(cwbvh_width + 1));
  for (int c = 0; c < children.count; ++c) {
    const Vec3 a = Vec3(offset, -offset, 0.5f * offset) + point_in_cube(random, extent);
    const bool flat = random.bits() % 4 == 0;
    children.bounds[c].grow(a);
    children.bounds[c].grow(flat ? a : a + point_in_cube(random, extent * 0.1f));
    children.triangles[c] = random.below(cwbvh_leaf_max + 1);
  }
  return children;
}

void expect_tight_and_conservative(const CwbvhChildren& children) {
  const CwbvhSlots slots = assign_cwbvh_slots(children);
  const CwbvhNode node = encode_cwbvh_node(children, slots, 11, 22);
  for (int s = 0; s < cwbvh_width; ++s) {
    if (slots.child[s] == no_cwbvh_child) continue;
    const Bounds& box = children.bounds[slots.child[s]];
    const ExactBox decoded = exact_child_box(node, s);
    for (int i = 0; i < 3; ++i) {
      const double step = node.step(i) * (1.0 + 2.0 * cwbvh_grid_tolerance);
      ASSERT_LE(decoded.min[i], static_cast<double>(box.min[i]));
      ASSERT_GE(decoded.max[i], static_cast<double>(box.max[i]));
      ASSERT_LE(static_cast<double>(box.min[i]) - decoded.min[i], step) << "not tight";
      ASSERT_LE(decoded.max[i] - static_cast<double>(box.max[i]), step) << "not tight";
    }
  }
}

TEST(EncodeCwbvh, DecodedBoxesContainTheOriginals) {
  TestRandom random(3);
  for (const float offset : {0.0f, 1.0f, 1e5f, -3e7f}) {
    for (const float extent : {1e-30f, 1e-5f, 1e-3f, 0.7f, 1e5f, 1e20f}) {
      SCOPED_TRACE(testing::Message() << "offset " << offset << ", extent " << extent);
      for (int i = 0; i < 2000; ++i) {
        expect_tight_and_conservative(random_children(random, offset, extent));
        if (HasFatalFailure()) return;
      }
    }
  }
}

TEST(EncodeCwbvh, TheGridIsFineAndCovers) {
  TestRandom random(4);
  int exact = 0;
  for (int i = 0; i < 100'000; ++i) {
    const auto low = static_cast<float>(random.uniform(-10, 10));
    const float high = low + static_cast<float>(random.log_uniform(1e-6, 1e6));
    const CwbvhGrid grid = make_cwbvh_grid(low, high);
    const double step = grid.step, extent = static_cast<double>(high) - low;
    ASSERT_GE(255 * step + step * cwbvh_grid_tolerance, extent) << low << ' ' << high;
    ASSERT_LE(127 * step, extent) << low << ' ' << high;
    ASSERT_LE(grid.ceil_of(high), 255.0f);
    exact += grid.ceil_of(high) == grid.floor_of(high) ? 1 : 0;
  }
  EXPECT_GE(exact, 90'000);  // the high end lies on the grid
}

TEST(EncodeCwbvh, WallsOfARoomAreFlat) {
  TestRandom random(8);
  int flat = 0, walls = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 half = Vec3(600) + point_in_cube(random, 100), center = point_in_cube(random, 200);
    const Bounds room = {center - half, center + half};
    CwbvhChildren children;
    children.count = 6;
    for (int c = 0; c < 6; ++c) {
      Bounds wall = room;
      (c % 2 == 0 ? wall.max : wall.min)[c / 2] = (c % 2 == 0 ? room.min : room.max)[c / 2];
      children.bounds[c] = hit_bounds(wall.min, wall.max, wall.min);
      children.triangles[c] = 2;
    }
    const CwbvhSlots slots = assign_cwbvh_slots(children);
    const CwbvhNode node = encode_cwbvh_node(children, slots, 0, 0);
    for (int s = 0; s < cwbvh_width; ++s) {
      if (slots.child[s] == no_cwbvh_child) continue;
      const std::uint8_t* planes = &node.planes[slots.child[s] / 2][2 * s];
      flat += planes[0] == planes[1] ? 1 : 0, ++walls;
    }
  }
  EXPECT_EQ(walls, 6000);
  EXPECT_GE(flat, 0.9 * walls);
}

/// A table with two legs and things on it; its top is the second child.
CwbvhChildren make_table(TestRandom& random) {
  CwbvhChildren children;
  children.count = 8;
  const float top = static_cast<float>(random.uniform(0.5, 1.2));
  const auto flat = [](const Vec3& low, const Vec3& high) { return hit_bounds(low, high, low); };
  children.bounds[0] = {{1, 1, 0}, {1.1f, 2, top}};
  children.bounds[1] = flat({1, 1, top}, {3, 2, top});
  children.bounds[2] = {{2.9f, 1, 0}, {3, 2, top}};
  for (int c = 3; c < 8; ++c) {
    const Vec3 at(1.2f + 0.3f * static_cast<float>(c - 3), 1.3f, top);
    const Vec3 size = Vec3(0.2f) + point_in_cube(random, 0.1f);
    children.bounds[c] = {at, at + size};
  }
  for (int c = 0; c < 8; ++c) children.triangles[c] = c == 1 ? 2 : 0;
  return children;
}

// Rays that leave the table do not meet it again, and boxes stay tight.
TEST(EncodeCwbvh, FlatChildrenInsideANodeAreFlat) {
  TestRandom random(9);
  int flat = 0, coarse = 0;
  constexpr int tables = 1000;
  for (int i = 0; i < tables; ++i) {
    const CwbvhChildren children = make_table(random);
    expect_tight_and_conservative(children);
    const CwbvhSlots slots = assign_cwbvh_slots(children);
    const CwbvhNode node = encode_cwbvh_node(children, slots, 0, 0);
    for (int s = 0; s < cwbvh_width; ++s) {
      if (slots.child[s] == 1) flat += node.planes[2][2 * s] == node.planes[2][2 * s + 1] ? 1 : 0;
    }
    ASSERT_LE(node.step(2), 1.5f / 16);
    coarse += node.step(2) > 1.5f / 64 ? 1 : 0;
  }
  EXPECT_GE(flat, 0.95 * tables);
  EXPECT_LE(coarse, 0.05 * tables);
}

TEST(EncodeCwbvh, FieldsNameEachChildOnce) {
  TestRandom random(5);
  for (int i = 0; i < 10'000; ++i) {
    const CwbvhChildren children = random_children(random, 0, 1);
    const CwbvhSlots slots = assign_cwbvh_slots(children);
    const CwbvhNode node = encode_cwbvh_node(children, slots, 11, 22);
    EXPECT_EQ(node.child_base, 11u);
    EXPECT_EQ(node.triangle_base, 22u);
    EXPECT_EQ(node.inner_mask() & node.leaf_mask(), 0u);
    EXPECT_EQ(node.pair_mask() & ~node.leaf_mask(), 0u);
    std::uint32_t seen = 0, inner = 11, triangles = 22;
    for (std::uint32_t s = 0; s < cwbvh_width; ++s) {
      const std::uint32_t c = slots.child[s];
      const bool is_used = (node.used_mask() >> s & 1) != 0;
      EXPECT_EQ(is_used, c != no_cwbvh_child);
      if (!is_used || c == no_cwbvh_child) continue;
      seen |= 1u << c;
      const CwbvhChild child = cwbvh_child(node, s);
      EXPECT_EQ(child.count, children.triangles[c]);
      EXPECT_EQ(child.index, child.count == 0 ? inner++ : triangles);
      triangles += child.count;
    }
    EXPECT_EQ(seen, (1u << children.count) - 1);
  }
}

/// The sum that the assignment minimises, by trying every permutation.
double best_cost(const CwbvhChildren& children, const Vec3& center) {
  std::array<int, cwbvh_width> child;
  std::iota(child.begin(), child.end(), 0);
  double best = HUGE_VAL;
  do {
    double cost = 0;
    for (int s = 0; s < cwbvh_width; ++s) {
      cost += cwbvh_slot_cost(children.bounds[child[s]].center() - center, s);
    }
    best = std::min(best, cost);
  } while (std::next_permutation(child.begin(), child.end()));
  return best;
}

TEST(EncodeCwbvh, SlotsAreNearlyTheBestPermutation) {
  TestRandom random(6);
  double found = 0, best = 0;
  for (int i = 0; i < 20; ++i) {
    CwbvhChildren children;
    children.count = cwbvh_width;
    Bounds all;
    for (Bounds& box : children.bounds) {
      box = {}, box.grow(point_in_cube(random, 1)), box.grow(point_in_cube(random, 1));
      all.grow(box);
    }
    const CwbvhSlots slots = assign_cwbvh_slots(children);
    for (int s = 0; s < cwbvh_width; ++s) {
      found += cwbvh_slot_cost(children.bounds[slots.child[s]].center() - all.center(), s);
    }
    best += best_cost(children, all.center());
  }
  EXPECT_LE(found, 0.9 * best);  // both are negative
}

TEST(EncodeCwbvh, OctantsVisitCornersFromNearToFar) {
  CwbvhChildren children;
  children.count = cwbvh_width;
  for (int c = 0; c < cwbvh_width; ++c) {  // child c at corner 7 - c
    const Vec3 corner((c & 1) ? -1 : 1, (c & 2) ? -1 : 1, (c & 4) ? -1 : 1);
    children.bounds[c] = {corner - 0.1f, corner + 0.1f};
    children.triangles[c] = 0;
  }
  const CwbvhSlots slots = assign_cwbvh_slots(children);
  for (int octant = 0; octant < 8; ++octant) {
    const Vec3 direction((octant & 1) ? -1 : 1, (octant & 2) ? -1 : 1, (octant & 4) ? -1 : 1);
    const auto depth = [&](int order) {
      return glm::dot(direction, children.bounds[slots.child[order ^ octant]].center());
    };
    EXPECT_FLOAT_EQ(depth(0), -3);
    EXPECT_FLOAT_EQ(depth(7), 3);
  }
}

}  // namespace
}  // namespace pt
