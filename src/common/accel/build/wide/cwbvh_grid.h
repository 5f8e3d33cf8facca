// The grids on which a wide node's children lie.
//
// A ray that leaves a wall, a floor or a table meets its box once more if the grid has no plane
// there and the box is rounded to a thicker one. So a grid has both ends of its node, or else the
// planes of flat children.
#pragma once

#include "common/accel/nodes.h"
#include "common/geometry/bounds.h"

namespace pt {

/// The children that a wide node is to have, in any order.
struct CwbvhChildren {
  int count = 0;  ///< 0..cwbvh_width
  Bounds bounds[cwbvh_width];
  std::uint32_t triangles[cwbvh_width];  ///< 1..cwbvh_leaf_max; 0: an inner node
};

/// The grid of one axis: origin + step * q.
struct CwbvhGrid {
  float origin, step;  ///< the step has 16 significant bits

  /// The largest q at or below x, and the smallest at or above, of those from 0 on; planes that x
  /// misses by no more than the tolerance count as met.
  PT_HD float floor_of(float x) const { return floorf(coordinate_of(x) + snap); }
  PT_HD float ceil_of(float x) const { return ceilf(fmaxf(coordinate_of(x) - snap, 0.0f)); }

  // With the margins of hit_bounds, walls of a room up to twice as long as wide are flat. What is
  // left of the tolerance is the traversal's.
  static constexpr float snap = 4.0f / 4096.0f;
  static constexpr float fit = 0.5f / 4096.0f;

 private:
  PT_HD float coordinate_of(float x) const { return (x - origin) / step; }
};

/// A step of 16 significant bits, rounded to nearest; never 0.
PT_HD float round_cwbvh_step(float step) {
  const std::uint32_t bits = (float_to_bits(step) + 0x80u) & 0xffffff00u;
  return bits_to_float(bits < 0x00800000u ? 0x00800000u : bits);
}

/// A fine grid that covers [low, high], both of which lie on it, wherever a step can be found whose
/// upper 24 bits say it well enough; |low|, |high| < 1e30.
PT_HD CwbvhGrid make_cwbvh_grid(float low, float high) {
  const float extent = high - low;
  for (int last = 255; last >= 128; --last) {
    const auto count = static_cast<float>(last);
    const float step = round_cwbvh_step(extent / count);
    const float rest = fabsf(fused_multiply_add(step, -count, extent));
    if (rest <= step * CwbvhGrid::fit) return {low, step};
  }
  return {low, round_cwbvh_step(extent * (1.0f / 254.0f))};
}

/// Planes of one axis on which children are flat, and how much of all children's faces lies there.
struct CwbvhPlanes {
  static constexpr int most = 4;  ///< that a grid is fitted to: those of the largest faces
  int count = 0;
  float low[2 * cwbvh_width], high[2 * cwbvh_width];  ///< a flat child is as thick as its margins
  float area[2 * cwbvh_width];                        ///< of the faces

  /// Adds a face to its plane; `begins`: it may be the first there.
  PT_HD void add(float lower, float upper, float face, float near, bool begins) {
    for (int i = 0; i < count; ++i) {
      if (lower > high[i] + near || upper < low[i] - near) continue;
      low[i] = fminf(low[i], lower), high[i] = fmaxf(high[i], upper);
      area[i] += face;
      return;
    }
    if (!begins) return;
    low[count] = lower, high[count] = upper, area[count++] = face;
  }

  /// Sorts by descending area and drops all but the first `most`.
  PT_HD void keep_largest() {
    for (int i = 0; i < count && i < most; ++i) {
      for (int k = i + 1; k < count; ++k) {
        if (area[k] > area[i]) exchange(i, k);
      }
    }
    count = count < most ? count : most;
  }

 private:
  PT_HD void exchange(int i, int k) {
    const float l = low[i], h = high[i], a = area[i];
    low[i] = low[k], high[i] = high[k], area[i] = area[k];
    low[k] = l, high[k] = h, area[k] = a;
  }
};

PT_HD CwbvhPlanes find_cwbvh_planes(const CwbvhChildren& children, int axis, float extent) {
  constexpr float flat = 0.0002f;  // of the node's extent: as thick as margins may be, no more
  const float near = extent * (1.0f / (255.0f * 4096.0f));
  const int u = axis == 2 ? 0 : axis + 1, v = axis == 0 ? 2 : axis - 1;
  CwbvhPlanes planes;
  for (const bool wants_flat : {true, false}) {
    for (int c = 0; c < children.count; ++c) {
      const Bounds& b = children.bounds[c];
      const Vec3 size = b.max - b.min;
      const float face = size[u] * size[v];
      if ((size[axis] <= flat * extent) != wants_flat) continue;
      if (wants_flat) {
        planes.add(b.min[axis], b.max[axis], 2 * face, near, true);
      } else {
        planes.add(b.min[axis], b.min[axis], face, near, false);
        planes.add(b.max[axis], b.max[axis], face, near, false);
      }
    }
  }
  planes.keep_largest();
  return planes;
}

/// What a grid is worth to rays: the area of the faces whose planes it has, less what its steps add
/// to that of the boxes. `sides`: half the sum of the children's circumferences around the axis.
struct CwbvhGridValue {
  float area;
  bool has_all;  ///< planes
};

PT_HD CwbvhGridValue value_of_grid(const CwbvhPlanes& planes, float sides, const CwbvhGrid& grid) {
  constexpr float weight = 0.1f;  // of a face, met when a ray begins there, beside a box's
  constexpr float room = 0.95f * CwbvhGrid::snap;
  float sum = 0;
  bool has_all = true;
  for (int i = 0; i < planes.count; ++i) {
    const float a = (planes.low[i] - grid.origin) / grid.step;
    const float b = (planes.high[i] - grid.origin) / grid.step;
    const float q = floorf(fused_multiply_add(0.5f, a + b, 0.5f));
    const float off = fmaxf(q - a, b - q);  // of the farther face, in steps
    if (off <= room) {
      sum = fused_multiply_add(planes.area[i],
                               fused_multiply_add(-0.4f / CwbvhGrid::snap, off, 1.0f), sum);
    } else {
      has_all = false;
    }
  }
  return {weight * sum - grid.step * sides, has_all};
}

/// Offers grids with `plane` whose step is a part of the distance to `other`, down to a sixteenth
/// as fine as grids can be; with `other` too, therefore.
template <class Offer>
PT_HD void offer_common_grids(float plane, float other, float extent, Offer&& offer) {
  const float distance = fabsf(plane - other);
  const float finest = floorf(255.0f * (distance / extent));
  for (float n = finest; n >= 1.0f && 16.0f * n >= finest; n -= 1.0f) offer(plane, distance / n);
}

/// The grid of a node's axis, which covers [low, high]: that of make_cwbvh_grid, or one with the
/// planes of flat children, coarser if need be, where that is worth more.
PT_HD CwbvhGrid fit_cwbvh_grid(const CwbvhChildren& children, int axis, float low, float high) {
  CwbvhGrid best = make_cwbvh_grid(low, high);
  const float extent = high - low;
  const CwbvhPlanes planes = find_cwbvh_planes(children, axis, extent);
  if (planes.count == 0) return best;
  float sides = 0, faces = 0;
  for (int c = 0; c < children.count; ++c) {
    const Vec3 size = children.bounds[c].max - children.bounds[c].min;
    for (int i = 0; i < 3; ++i) sides += i != axis ? size[i] : 0.0f;
  }
  for (int i = 0; i < planes.count; ++i) faces += planes.area[i];
  const CwbvhGridValue present = value_of_grid(planes, sides, best);
  if (present.has_all) return best;
  float least = fused_multiply_add(0.002f, faces, present.area);
  const auto offer = [&](float plane, float wanted) {
    const float step = round_cwbvh_step(wanted);
    constexpr float end =
        0.9f * CwbvhGrid::snap;  // how far beyond the grid an end may lie, in steps
    const float below = ceilf((plane - low) / step - end);
    const CwbvhGrid grid = {fused_multiply_add(-below, step, plane), step};
    if (grid.origin - low > end * step) return;
    if ((high - grid.origin) / step > 255.0f + end) return;
    const float area = value_of_grid(planes, sides, grid).area;
    if (area > least) least = area, best = grid;
  };
  const auto middle = [&](int i) { return 0.5f * (planes.low[i] + planes.high[i]); };
  for (int i = 0; i < planes.count; ++i) {
    offer_common_grids(middle(i), low, extent, offer);
    offer_common_grids(middle(i), high, extent, offer);
    for (int k = 0; k < i; ++k) offer_common_grids(middle(i), middle(k), extent, offer);
    for (float n = 254.0f; n > 16.0f; n *= 0.98f) offer(middle(i), extent / n);
  }
  return best;
}

}  // namespace pt
