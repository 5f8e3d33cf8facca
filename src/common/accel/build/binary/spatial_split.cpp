#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "common/accel/build/binary/split.h"

namespace pt {
namespace {

using DVec3 = glm::dvec3;

/// A convex polygon: a triangle has three corners, and each of the box's planes adds at most one.
struct Polygon {
  int count = 0;
  DVec3 corner[9];

  void add(const DVec3& p) { corner[count++] = p; }
};

/// Sutherland and Hodgman's step: keeps what lies where sign * x[axis] <= sign * plane.
Polygon clip(const Polygon& polygon, int axis, double plane, double sign) {
  Polygon result;
  for (int i = 0; i < polygon.count; ++i) {
    const DVec3& a = polygon.corner[i];
    const DVec3& b = polygon.corner[(i + 1) % polygon.count];
    const double beyond_a = sign * (a[axis] - plane), beyond_b = sign * (b[axis] - plane);
    if (beyond_a <= 0) result.add(a);
    if ((beyond_a < 0 && beyond_b > 0) || (beyond_a > 0 && beyond_b < 0)) {
      DVec3 crossing = a + (beyond_a / (beyond_a - beyond_b)) * (b - a);
      crossing[axis] = plane;
      result.add(crossing);
    }
  }
  return result;
}

float round_down(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) > x ? std::nextafterf(f, -HUGE_VALF) : f;
}
float round_up(double x) { return -round_down(-x); }

}  // namespace

Bounds clipped_bounds(const Vec3 (&vertices)[3], const Bounds& box) {
  const DVec3 tolerance(hit_margin(triangle_bounds(vertices[0], vertices[1], vertices[2])));
  Polygon polygon;
  for (const Vec3& v : vertices) polygon.add(DVec3(v));
  for (int axis = 0; axis < 3; ++axis) {
    polygon = clip(polygon, axis, box.max[axis] + tolerance[axis], 1);
    polygon = clip(polygon, axis, box.min[axis] - tolerance[axis], -1);
  }
  if (polygon.count == 0) return {};
  DVec3 low(HUGE_VAL), high(-HUGE_VAL);
  for (int i = 0; i < polygon.count; ++i) {
    low = glm::min(low, polygon.corner[i]), high = glm::max(high, polygon.corner[i]);
  }
  Bounds result;
  for (int axis = 0; axis < 3; ++axis) {
    result.min[axis] =
        std::clamp(round_down(low[axis] - tolerance[axis]), box.min[axis], box.max[axis]);
    result.max[axis] =
        std::clamp(round_up(high[axis] + tolerance[axis]), box.min[axis], box.max[axis]);
  }
  return result;
}

namespace {

constexpr int bin_count = 16;

struct SpatialBin : Box4 {
  std::uint32_t entering = 0, leaving = 0;  // references whose first, whose last bin this is
};

struct SpatialBins {
  std::array<std::array<SpatialBin, bin_count>, 3> of;

  void add(const SpatialBins& other) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int b = 0; b < bin_count; ++b) {
        SpatialBin& bin = of[axis][b];
        const SpatialBin& from = other.of[axis][b];
        bin.grow(from), bin.entering += from.entering, bin.leaving += from.leaving;
      }
    }
  }
};

/// Equidistant planes through a box; plane 0 is its lower face.
struct Planes {
  Float4 base, width, inverse;

  explicit Planes(const Box4& box) : base(box.low), width((box.high - box.low) / bin_count) {
    for (int axis = 0; axis < 4; ++axis) {
      inverse[axis] = axis < 3 && width[axis] > 1e-30f ? 1.0f / width[axis] : 0.0f;
    }
  }
  float plane(int axis, int i) const { return base[axis] + static_cast<float>(i) * width[axis]; }
  int bin(int axis, float x) const {
    const float at = (x - base[axis]) * inverse[axis];
    return static_cast<int>(std::clamp(at, 0.0f, static_cast<float>(bin_count - 1)));
  }
};

bool is_box(const Box4& box) {
  return box.low[0] <= box.high[0] && box.low[1] <= box.high[1] && box.low[2] <= box.high[2];
}

// Puts the parts of a triangle that spans several bins into them: its edges cross the planes in
// between. Only an estimate, so that single precision will do.
void add_parts(const Float4 (&v)[3], const BuildReference& r, const Planes& planes, int axis,
               int first, int last, std::array<SpatialBin, bin_count>& bins) {
  std::array<Box4, bin_count> part;
  std::fill(part.begin() + first, part.begin() + last + 1, Box4());
  for (int i = 0; i < 3; ++i) {
    const bool ascending = v[i][axis] <= v[(i + 1) % 3][axis];
    const Float4 a = ascending ? v[i] : v[(i + 1) % 3], b = ascending ? v[(i + 1) % 3] : v[i];
    const int from = std::clamp(planes.bin(axis, a[axis]), first, last);
    const int to = std::clamp(planes.bin(axis, b[axis]), first, last);
    part[from].grow(a), part[to].grow(b);
    const float length = b[axis] - a[axis];
    for (int j = from + 1; j <= to; ++j) {
      const float s = std::clamp((planes.plane(axis, j) - a[axis]) / length, 0.0f, 1.0f);
      const Float4 crossing = a + s * (b - a);
      part[j - 1].grow(crossing), part[j].grow(crossing);
    }
  }
  for (int b = first; b <= last; ++b) {
    const Box4 inside{max4(part[b].low, r.low), min4(part[b].high, r.high)};
    if (is_box(inside)) bins[b].grow(inside);
  }
}

void add_reference(const BuildReference& r, const Planes& planes, const TriangleOf& triangle_of,
                   SpatialBins& bins) {
  bool loaded = false;
  Float4 v[3];
  for (int axis = 0; axis < 3; ++axis) {
    const int first = planes.bin(axis, r.low[axis]), last = planes.bin(axis, r.high[axis]);
    ++bins.of[axis][first].entering, ++bins.of[axis][last].leaving;
    if (first == last) {
      bins.of[axis][first].grow(r);
      continue;
    }
    if (!loaded) {
      const Triangle t = triangle_of(r.id());
      v[0] = to_float4(t.v0), v[1] = to_float4(t.v1), v[2] = to_float4(t.v2);
      loaded = true;
    }
    add_parts(v, r, planes, axis, first, last, bins.of[axis]);
  }
}

SpatialBins make_bins(std::span<const BuildReference> references, const ReferenceRange& range,
                      const Planes& planes, const TriangleOf& triangle_of) {
  const auto fill = [&](const tbb::blocked_range<std::uint32_t>& part, SpatialBins bins) {
    for (std::uint32_t i = part.begin(); i < part.end(); ++i) {
      add_reference(references[i], planes, triangle_of, bins);
    }
    return bins;
  };
  const tbb::blocked_range<std::uint32_t> all(range.begin, range.end, range_block);
  if (range.size() <= range_block) return fill(all, {});
  return tbb::parallel_reduce(all, SpatialBins(), fill, [](SpatialBins a, const SpatialBins& b) {
    a.add(b);
    return a;
  });
}

void try_axis(const std::array<SpatialBin, bin_count>& bins, const Planes& planes, int axis,
              SpatialSplit& best) {
  std::array<Box4, bin_count + 1> right;
  std::array<std::uint32_t, bin_count + 1> right_count{};
  for (int b = bin_count - 1; b > 0; --b) {
    right[b] = right[b + 1], right[b].grow(bins[b]);
    right_count[b] = right_count[b + 1] + bins[b].leaving;
  }
  Box4 left;
  std::uint32_t left_count = 0;
  for (int b = 1; b < bin_count; ++b) {
    left.grow(bins[b - 1]), left_count += bins[b - 1].entering;
    if (left_count == 0 || right_count[b] == 0 || !is_box(left) || !is_box(right[b])) continue;
    const float cost = left.half_area() * static_cast<float>(left_count) +
                       right[b].half_area() * static_cast<float>(right_count[b]);
    if (cost < best.cost) {
      best = {cost, axis, planes.plane(axis, b), left, right[b], left_count, right_count[b]};
    }
  }
}

enum class Side { left, right, both };

Side side_of(const BuildReference& r, const SpatialSplit& split) {
  if (r.high[split.axis] <= split.plane) return Side::left;
  return r.low[split.axis] >= split.plane ? Side::right : Side::both;
}

float half_area(Box4 a, const BuildReference& b) {
  a.grow(b);
  return a.half_area();
}

// Stich et al., section 4.4: a reference that is not cut costs larger boxes, and saves a reference.
Side cheapest_side(const BuildReference& r, const SpatialSplit& split) {
  const auto left = static_cast<float>(split.left_count);
  const auto right = static_cast<float>(split.right_count);
  const float all_left =
      half_area(split.left_bounds, r) * left + split.right_bounds.half_area() * (right - 1.0f);
  const float all_right =
      split.left_bounds.half_area() * (left - 1.0f) + half_area(split.right_bounds, r) * right;
  if (split.cost <= all_left && split.cost <= all_right) return Side::both;
  return all_left <= all_right ? Side::left : Side::right;
}

/// The box's part on one side of the plane, and the tolerance beyond.
Bounds half_of(const BuildReference& r, const SpatialSplit& split, Side side, float tolerance) {
  Bounds box{{r.low[0], r.low[1], r.low[2]}, {r.high[0], r.high[1], r.high[2]}};
  float& border = side == Side::left ? box.max[split.axis] : box.min[split.axis];
  border = side == Side::left ? std::min(border, raised(split.plane, tolerance))
                              : std::max(border, lowered(split.plane, tolerance));
  return box;
}

void set_side(BuildReference& r, Side side) { r.high[3] = side == Side::left ? 0.0f : 1.0f; }
bool is_left(const BuildReference& r) { return r.high[3] == 0.0f; }

// Says on which side `r` lies from now on; if cut, `r` is the left part and the right one is added.
void cut(BuildReference& r, const SpatialSplit& split, const TriangleOf& triangle_of,
         std::vector<BuildReference>& right_parts) {
  Side side = side_of(r, split);
  if (side == Side::both) side = cheapest_side(r, split);
  if (side == Side::both) {
    const Triangle t = triangle_of(r.id());
    const Vec3 v[3] = {t.v0, t.v1, t.v2};
    const float tolerance = hit_margin(triangle_bounds(t.v0, t.v1, t.v2))[split.axis];
    const Bounds left = clipped_bounds(v, half_of(r, split, Side::left, tolerance));
    const Bounds right = clipped_bounds(v, half_of(r, split, Side::right, tolerance));
    side = right.is_empty() ? Side::left : Side::right;
    if (!left.is_empty() && !right.is_empty()) {
      right_parts.push_back(make_reference(right, r.id()));
      set_side(right_parts.back(), Side::right);
      r = make_reference(left, r.id());
      side = Side::left;
    }
  }
  set_side(r, side);
}

}  // namespace

SpatialSplit find_spatial_split(std::span<const BuildReference> references,
                                const ReferenceRange& range, const TriangleOf& triangle_of) {
  const Planes planes(range.bounds);
  const SpatialBins bins = make_bins(references, range, planes, triangle_of);
  SpatialSplit best;
  for (int axis = 0; axis < 3; ++axis) {
    if (planes.inverse[axis] > 0.0f) try_axis(bins.of[axis], planes, axis, best);
  }
  return best;
}

std::uint32_t count_cut(std::span<const BuildReference> references, const ReferenceRange& range,
                        const SpatialSplit& split) {
  const auto both = [&](const BuildReference& r) { return side_of(r, split) == Side::both; };
  const auto first = references.begin() + range.begin;
  return static_cast<std::uint32_t>(std::count_if(first, first + range.size(), both));
}

RangeHalves split_spatially(std::span<BuildReference> references, const ReferenceRange& range,
                            const SpatialSplit& split, const TriangleOf& triangle_of) {
  const std::uint32_t blocks = (range.size() + range_block - 1) / range_block;
  std::vector<std::vector<BuildReference>> right_parts(blocks);
  tbb::parallel_for(0u, blocks, [&](std::uint32_t b) {
    const std::uint32_t begin = range.begin + b * range_block;
    const std::uint32_t end = std::min(begin + range_block, range.end);
    for (std::uint32_t i = begin; i < end; ++i) {
      cut(references[i], split, triangle_of, right_parts[b]);
    }
  });
  std::uint32_t end = range.end;
  for (const auto& parts : right_parts) {
    std::copy(parts.begin(), parts.end(), references.begin() + end);
    end += static_cast<std::uint32_t>(parts.size());
  }
  return partition_range(references, range.begin, end, is_left);
}

}  // namespace pt
