// Wide nodes: no box loses anything to quantisation, slots go from near to far, and the bit fields
// say what the children are.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "check_tree.h"
#include "common/accel/encode_cwbvh.h"
#include "triangle_meshes.h"

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
      const double step = std::ldexp(1.0, node.exponent[i] - 127);
      ASSERT_LE(decoded.min[i], static_cast<double>(box.min[i]));
      ASSERT_GE(decoded.max[i], static_cast<double>(box.max[i]));
      ASSERT_LT(static_cast<double>(box.min[i]) - decoded.min[i], step) << "not tight";
      ASSERT_LT(decoded.max[i] - static_cast<double>(box.max[i]), step) << "not tight";
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

TEST(EncodeCwbvh, TheGridIsTheFinestThatCovers) {
  TestRandom random(4);
  for (int i = 0; i < 100'000; ++i) {
    const auto low = static_cast<float>(random.uniform(-10, 10));
    const float high = low + static_cast<float>(random.log_uniform(1e-6, 1e6));
    const CwbvhGrid grid = make_cwbvh_grid(low, high);
    const auto covered = [&](int exponent) {
      return low + std::ldexp(255.0, exponent - 127) >= static_cast<double>(high);
    };
    ASSERT_TRUE(covered(static_cast<int>(grid.exponent)));
    ASSERT_FALSE(covered(static_cast<int>(grid.exponent) - 1)) << low << ' ' << high;
  }
}

TEST(EncodeCwbvh, FieldsNameEachChildOnce) {
  TestRandom random(5);
  for (int i = 0; i < 10'000; ++i) {
    const CwbvhChildren children = random_children(random, 0, 1);
    const CwbvhSlots slots = assign_cwbvh_slots(children);
    const CwbvhNode node = encode_cwbvh_node(children, slots, 11, 22);
    EXPECT_EQ(node.child_base, 11u);
    EXPECT_EQ(node.triangle_base, 22u);
    std::uint32_t seen = 0, triangles = 0;
    for (std::uint32_t s = 0; s < cwbvh_width; ++s) {
      const std::uint32_t c = slots.child[s];
      const bool inner = (node.inner_mask >> s & 1) != 0;
      if (c == no_cwbvh_child) {
        EXPECT_EQ(node.meta[s], 0);
        EXPECT_FALSE(inner);
        continue;
      }
      seen |= 1u << c;
      EXPECT_EQ(inner, children.triangles[c] == 0);
      if (inner) {
        EXPECT_EQ(node.meta[s], 0b001u << 5 | (24 + s));
      } else {
        constexpr std::array<int, 4> unary = {0, 0b001, 0b011, 0b111};
        EXPECT_EQ(node.meta[s] >> 5, unary[children.triangles[c]]);
        EXPECT_EQ(node.meta[s] & 31u, triangles);
        triangles += children.triangles[c];
      }
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
