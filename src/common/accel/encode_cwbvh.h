// Encodes one node of the compressed wide BVH; the builders of both devices use it.
#pragma once

#include "common/accel/cwbvh.h"
#include "common/geometry/bounds.h"

namespace pt {

inline constexpr int cwbvh_width = 8;
inline constexpr std::uint8_t no_cwbvh_child = 0xff;

/// The children that a wide node is to have, in any order.
struct CwbvhChildren {
  int count = 0;  ///< 0..cwbvh_width
  Bounds bounds[cwbvh_width];
  std::uint32_t triangles[cwbvh_width];  ///< 1..cwbvh_leaf_max; 0: an inner node
};

/// Slot -> child, or no_cwbvh_child. Inner nodes lie in memory in the order of their slots, and so
/// do the leaves' triangles.
struct CwbvhSlots {
  std::uint8_t child[cwbvh_width];
};

/// a - b as a rounded value and the exact rest (Knuth's TwoSum).
struct ExactDifference {
  float value, rest;
};
PT_HD ExactDifference exact_difference(float a, float b) {
  const float value = add_rounded(a, -b);
  const float minus_b = add_rounded(value, -a);
  const float rest_a = add_rounded(a, -add_rounded(value, -minus_b));
  return {value, add_rounded(rest_a, add_rounded(-b, -minus_b))};
}

/// The grid of one axis: origin + 2^(exponent - 127) q.
struct CwbvhGrid {
  float origin;
  std::uint32_t exponent;

  PT_HD float scale() const { return bits_to_float(exponent << 23); }
  PT_HD float inverse_scale() const { return bits_to_float((254u - exponent) << 23); }

  /// The largest q at or below x >= origin, and the smallest at or above. Exact: a power of two
  /// scales without error, and rounding the difference is monotone, so that only a difference that
  /// falls on the grid needs a look at its rest.
  PT_HD float floor_of(float x) const {
    const ExactDifference d = exact_difference(x, origin);
    const float scaled = d.value * inverse_scale();
    const float q = floorf(scaled);
    return q == scaled && d.rest < 0.0f ? q - 1.0f : q;
  }
  PT_HD float ceil_of(float x) const {
    const ExactDifference d = exact_difference(x, origin);
    const float scaled = d.value * inverse_scale();
    const float q = ceilf(scaled);
    return q == scaled && d.rest > 0.0f ? q + 1.0f : q;
  }
};

/// The finest grid that covers [low, high] with q in 0..255; |low|, |high| < 1e30.
PT_HD CwbvhGrid make_cwbvh_grid(float low, float high) {
  const std::uint32_t bits = float_to_bits(add_rounded(high, -low) * (1.0f / 128.0f));
  CwbvhGrid grid{low, (bits >> 23) > 1u ? bits >> 23 : 1u};
  while (grid.ceil_of(high) > 255.0f) ++grid.exponent;
  return grid;
}

/// How far along the diagonal of `slot` a child lies: what the slots' assignment minimises in sum.
/// Bit `axis` of a slot is set for children further along that axis.
PT_HD float cwbvh_slot_cost(const Vec3& offset, int slot) {
  return ((slot & 1) != 0 ? -offset.x : offset.x) + ((slot & 2) != 0 ? -offset.y : offset.y) +
         ((slot & 4) != 0 ? -offset.z : offset.z);
}

/// Chooses the slots so that visiting by ascending (slot XOR octant) goes roughly from near to far,
/// bit `axis` of the octant being set where the ray's direction is negative: greedily, the cheapest
/// pair first, then by exchanging pairs (the paper's auction finds the same but for rare cases).
PT_HD CwbvhSlots assign_cwbvh_slots(const CwbvhChildren& children) {
  Bounds all;
  for (int c = 0; c < children.count; ++c) all.grow(children.bounds[c]);
  Vec3 offset[cwbvh_width];
  for (int c = 0; c < children.count; ++c) offset[c] = children.bounds[c].center() - all.center();
  CwbvhSlots slots;
  for (int s = 0; s < cwbvh_width; ++s) slots.child[s] = no_cwbvh_child;
  std::uint32_t placed = 0;
  for (int n = 0; n < children.count; ++n) {
    float best = HUGE_VALF;
    int best_child = -1, best_slot = -1;
    for (int c = 0; c < children.count; ++c) {
      for (int s = 0; s < cwbvh_width && (placed >> c & 1u) == 0; ++s) {
        const float cost = cwbvh_slot_cost(offset[c], s);
        if (slots.child[s] == no_cwbvh_child && (best_slot < 0 || cost < best)) {
          best = cost, best_child = c, best_slot = s;
        }
      }
    }
    slots.child[best_slot] = static_cast<std::uint8_t>(best_child);
    placed |= 1u << best_child;
  }
  const auto cost = [&](int slot, int at) {
    const std::uint8_t c = slots.child[slot];
    return c == no_cwbvh_child ? 0.0f : cwbvh_slot_cost(offset[c], at);
  };
  for (int a = 0; a < cwbvh_width; ++a) {
    for (int b = a + 1; b < cwbvh_width; ++b) {
      if (cost(a, b) + cost(b, a) < cost(a, a) + cost(b, b)) {
        const std::uint8_t c = slots.child[a];
        slots.child[a] = slots.child[b], slots.child[b] = c;
      }
    }
  }
  return slots;
}

/// The node. No child's box loses anything: decoded boxes contain the given ones exactly.
PT_HD CwbvhNode encode_cwbvh_node(const CwbvhChildren& children, const CwbvhSlots& slots,
                                  std::uint32_t child_base, std::uint32_t triangle_base) {
  Bounds all;
  for (int c = 0; c < children.count; ++c) all.grow(children.bounds[c]);
  if (all.is_empty()) all = {Vec3(0.0f), Vec3(0.0f)};
  const CwbvhGrid grid[3] = {make_cwbvh_grid(all.min.x, all.max.x),
                             make_cwbvh_grid(all.min.y, all.max.y),
                             make_cwbvh_grid(all.min.z, all.max.z)};
  CwbvhNode node;
  node.origin = all.min;
  for (int i = 0; i < 3; ++i) node.exponent[i] = static_cast<std::uint8_t>(grid[i].exponent);
  node.inner_mask = 0;
  node.child_base = child_base;
  node.triangle_base = triangle_base;
  std::uint32_t triangles = 0;
  for (int s = 0; s < cwbvh_width; ++s) {
    const std::uint8_t c = slots.child[s];
    const bool none = c == no_cwbvh_child;
    const Bounds box = none ? Bounds{all.max, all.min} : children.bounds[c];  // none: inside out
    const std::uint32_t count = none ? 0 : children.triangles[c];
    const std::uint32_t inner = 1u << 5 | (24u + static_cast<std::uint32_t>(s));
    const std::uint32_t leaf = ((1u << count) - 1u) << 5 | triangles;
    node.meta[s] = static_cast<std::uint8_t>(none ? 0 : count == 0 ? inner : leaf);
    if (!none && count == 0) node.inner_mask = static_cast<std::uint8_t>(node.inner_mask | 1u << s);
    triangles += count;
    node.low_x[s] = static_cast<std::uint8_t>(grid[0].floor_of(box.min.x));
    node.low_y[s] = static_cast<std::uint8_t>(grid[1].floor_of(box.min.y));
    node.low_z[s] = static_cast<std::uint8_t>(grid[2].floor_of(box.min.z));
    node.high_x[s] = static_cast<std::uint8_t>(grid[0].ceil_of(box.max.x));
    node.high_y[s] = static_cast<std::uint8_t>(grid[1].ceil_of(box.max.y));
    node.high_z[s] = static_cast<std::uint8_t>(grid[2].ceil_of(box.max.z));
  }
  return node;
}

/// The box of the child in `slot`, rounded to the nearest float.
PT_HD Bounds decode_cwbvh_bounds(const CwbvhNode& node, int slot) {
  const Vec3 scale(bits_to_float(static_cast<std::uint32_t>(node.exponent[0]) << 23),
                   bits_to_float(static_cast<std::uint32_t>(node.exponent[1]) << 23),
                   bits_to_float(static_cast<std::uint32_t>(node.exponent[2]) << 23));
  const Vec3 low(node.low_x[slot], node.low_y[slot], node.low_z[slot]);
  const Vec3 high(node.high_x[slot], node.high_y[slot], node.high_z[slot]);
  return {node.origin + scale * low, node.origin + scale * high};
}

}  // namespace pt
