// Encodes one node of the compressed wide BVH; the builders of both devices use it.
#pragma once

#include "common/accel/build/wide/cwbvh_grid.h"

namespace pt {

inline constexpr std::uint8_t no_cwbvh_child = 0xff;

/// Slot -> child, or no_cwbvh_child. Inner nodes lie in memory in the order of their slots, and so
/// do the leaves' triangles.
struct CwbvhSlots {
  std::uint8_t child[cwbvh_width];
};

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
    const CwbvhGrid grid = fit_cwbvh_grid(children, i, all.min[i], all.max[i]);
    node.origin[i] = grid.origin;
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
