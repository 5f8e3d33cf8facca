// Encodes one node of the compressed wide BVH; the builders of both devices use it.
#pragma once

#include "common/accel/cwbvh.h"
#include "common/geometry/bounds.h"

namespace pt {

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

/// The grid of one axis: origin + step * q.
struct CwbvhGrid {
  float origin, step;  ///< the step has 16 significant bits

  /// The largest q at or below x >= origin, and the smallest at or above; planes that x misses by
  /// no more than the tolerance count as met.
  PT_HD float floor_of(float x) const { return floorf(coordinate_of(x) + snap); }
  PT_HD float ceil_of(float x) const { return ceilf(fmaxf(coordinate_of(x) - snap, 0.0f)); }

  // With the margins of hit_bounds, walls of a room up to twice as long as wide are flat. What is
  // left of the tolerance is the traversal's.
  static constexpr float snap = 4.0f / 4096.0f;
  static constexpr float fit = 0.5f / 4096.0f;

 private:
  PT_HD float coordinate_of(float x) const { return add_rounded(x, -origin) / step; }
};

/// A step of 16 significant bits, rounded to nearest; never 0.
PT_HD float round_cwbvh_step(float step) {
  const std::uint32_t bits = (float_to_bits(step) + 0x80u) & 0xffffff00u;
  return bits_to_float(bits < 0x00800000u ? 0x00800000u : bits);
}

/// A fine grid that covers [low, high], both of which lie on it, wherever a step can be found whose
/// upper 24 bits say it well enough; |low|, |high| < 1e30.
PT_HD CwbvhGrid make_cwbvh_grid(float low, float high) {
  const float extent = add_rounded(high, -low);
  for (int last = 255; last >= 128; --last) {
    const auto count = static_cast<float>(last);
    const float step = round_cwbvh_step(extent / count);
    const float rest = fabsf(fused_multiply_add(step, -count, extent));
    if (rest <= step * CwbvhGrid::fit) return {low, step};
  }
  return {low, round_cwbvh_step(extent * (1.0f / 254.0f))};
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

/// The node. Decoded boxes contain the given ones to within cwbvh_grid_tolerance.
PT_HD CwbvhNode encode_cwbvh_node(const CwbvhChildren& children, const CwbvhSlots& slots,
                                  std::uint32_t child_base, std::uint32_t triangle_base) {
  Bounds all;
  for (int c = 0; c < children.count; ++c) all.grow(children.bounds[c]);
  if (all.is_empty()) all = {Vec3(0.0f), Vec3(0.0f)};
  CwbvhNode node;
  node.origin = all.min;
  node.child_base = child_base;
  node.triangle_base = triangle_base;
  std::uint32_t inner = 0, leaves = 0, pairs = 0;
  for (std::uint32_t s = 0; s < cwbvh_width; ++s) {
    const std::uint8_t c = slots.child[s];
    if (c == no_cwbvh_child) continue;
    const std::uint32_t count = children.triangles[c];
    (count == 0 ? inner : leaves) |= 1u << s;
    if (count == 2) pairs |= 1u << s;
  }
  const std::uint32_t masks[3] = {inner, leaves, pairs};
  PT_UNROLL(3)
  for (int i = 0; i < 3; ++i) {
    const CwbvhGrid grid = make_cwbvh_grid(all.min[i], all.max[i]);
    node.packed[i] = float_to_bits(grid.step) | masks[i];
    for (int s = 0; s < cwbvh_width; ++s) {
      const std::uint8_t c = slots.child[s];
      const bool none = c == no_cwbvh_child;
      const float low = none ? 255.0f : grid.floor_of(children.bounds[c].min[i]);  // none:
      const float high = none ? 0.0f : grid.ceil_of(children.bounds[c].max[i]);    // inside out
      node.planes[i][2 * s] = static_cast<std::uint8_t>(low);
      node.planes[i][2 * s + 1] = static_cast<std::uint8_t>(high);
    }
  }
  return node;
}

/// The box of the child in `slot`, rounded to the nearest float.
PT_HD Bounds decode_cwbvh_bounds(const CwbvhNode& node, int slot) {
  Bounds box;
  PT_UNROLL(3)
  for (int i = 0; i < 3; ++i) {
    const auto* planes = &node.planes[i][2 * slot];
    box.min[i] = fused_multiply_add(node.step(i), static_cast<float>(planes[0]), node.origin[i]);
    box.max[i] = fused_multiply_add(node.step(i), static_cast<float>(planes[1]), node.origin[i]);
  }
  return box;
}

}  // namespace pt
