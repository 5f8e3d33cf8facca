// Regular grids of what varies in a medium, and bounds of it that make empty space cheap.
#pragma once

#include "common/geometry/ray.h"
#include "common/math/transform.h"

namespace pt {

inline constexpr std::uint32_t no_grid = 0xffffffffu;

/// How a grid lies in space and in memory. Beyond its cube the outermost voxels go on, but not
/// along a ray without end.
struct alignas(16) VolumeGrid {
  Affine to_unit;                ///< from the world to the cube [0, 1]^3, which the voxels fill
  std::uint32_t size[3] = {};    ///< voxels, each at least 1
  std::uint32_t first = 0;       ///< index of its first value; x varies fastest, then y
  std::uint32_t cells[3] = {};   ///< of majorants; 0: it has none
  std::uint32_t first_cell = 0;  ///< index of the first of them, in the same order
  std::uint32_t channels = 1;    ///< 1, or 3 that stand side by side
  std::uint32_t interpolates =
      1;                   ///< trilinear between the middles of voxels; else constant in each
  std::uint32_t ends = 0;  ///< its outermost voxels are 0: it has nothing beyond its cube
  std::uint32_t unused = 0;
};

/// The grids of a scene.
struct VolumeGrids {
  const VolumeGrid* grids = nullptr;
  const float* values = nullptr;
  const float* majorants = nullptr;  ///< of a cell, at least the grid's largest value in it
};

namespace detail {

PT_HD std::uint32_t clamp_voxel(float index, std::uint32_t size) {
  return static_cast<std::uint32_t>(fminf(fmaxf(index, 0.0f), static_cast<float>(size - 1)));
}

/// The voxels on both sides of a coordinate in [0, 1], and how far it is from the first to the
/// second.
struct VoxelPair {
  std::uint32_t low, high;
  float between;

  PT_HD VoxelPair(float unit, std::uint32_t size) {
    const float x = fused_multiply_add(unit, static_cast<float>(size), -0.5f);
    const float below = floorf(x);
    low = clamp_voxel(below, size), high = clamp_voxel(below + 1.0f, size);
    between = x - below;
  }
};

template <class Value>
PT_HD auto interpolate_voxels(const VolumeGrid& grid, const Vec3& p, Value&& value) {
  const VoxelPair x(p.x, grid.size[0]), y(p.y, grid.size[1]), z(p.z, grid.size[2]);
  const auto row = [&](std::uint32_t j, std::uint32_t k) {
    const std::uint32_t first = grid.size[0] * (j + grid.size[1] * k);
    return interpolate(value(first + x.low), value(first + x.high), x.between);
  };
  return interpolate(interpolate(row(y.low, z.low), row(y.high, z.low), y.between),
                     interpolate(row(y.low, z.high), row(y.high, z.high), y.between), z.between);
}

template <class Value>
PT_HD auto value_at(const VolumeGrid& grid, const Vec3& p, Value&& value) {
  if (grid.interpolates != 0) return interpolate_voxels(grid, p, value);
  const auto voxel = [](float unit, std::uint32_t size) {
    return clamp_voxel(floorf(unit * static_cast<float>(size)), size);
  };
  const std::uint32_t j = voxel(p.y, grid.size[1]), k = voxel(p.z, grid.size[2]);
  return value(voxel(p.x, grid.size[0]) + grid.size[0] * (j + grid.size[1] * k));
}

}  // namespace detail

/// The grid's value at a point of the world; a single channel is grey.
PT_HD Color sample_grid(const VolumeGrids& grids, const VolumeGrid& grid, const Vec3& point) {
  const Vec3 p = grid.to_unit.point(point);
  const float* const values = grids.values + grid.first;
  if (grid.channels == 1) {
    return Color(detail::value_at(grid, p, [&](std::uint32_t i) { return values[i]; }));
  }
  return detail::value_at(grid, p, [&](std::uint32_t i) {
    return Color(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
  });
}

/// Where a walk along a ray through the cells of a grid has ended.
struct MajorantWalk {
  float t;         ///< distance from the ray's origin
  float depth;     ///< integral of the majorants over the distance walked
  float majorant;  ///< of the last cell
  bool arrives;    ///< at `t_max`, and not where the integral is what was wanted
};

/// Walks from `t` until the integral of the majorants over the distance is `depth_wanted`, or to
/// `t_max`, and without end only through the grid's cube (Amanatides and Woo 1987, 'A fast voxel
/// traversal algorithm for ray tracing'; pbrt-v4, section 11.4.2). It depends on nothing but its
/// arguments: a flight may pause at any collision.
PT_HD MajorantWalk walk_majorants(const VolumeGrids& grids, const VolumeGrid& grid, const Ray& ray,
                                  float t, float t_max, float depth_wanted) {
  const Vec3 size(static_cast<float>(grid.cells[0]), static_cast<float>(grid.cells[1]),
                  static_cast<float>(grid.cells[2]));
  const Vec3 origin = multiply_rounded(grid.to_unit.point(ray.origin), size);
  const Vec3 direction = multiply_rounded(grid.to_unit.vector(ray.direction), size);
  const auto inverse_of = [](float d) { return fabsf(d) > 1e-20f ? divide(1.0f, d) : 0.0f; };
  const Vec3 inverse(inverse_of(direction.x), inverse_of(direction.y), inverse_of(direction.z));
  float last = t_max;
  if (grid.ends != 0 || t_max >= infinite_distance) {  // the part in the cube
    const auto clip = [&](float from, float inverse_way, float length) {
      const float a = multiply_rounded(-from, inverse_way);
      const float b = multiply_rounded(length - from, inverse_way);
      const bool is_beside = inverse_way == 0.0f && !(from >= 0.0f && from <= length);
      if (inverse_way != 0.0f) t = fmaxf(t, fminf(a, b)), last = fminf(last, fmaxf(a, b));
      if (is_beside) last = t;
    };
    clip(origin.x, inverse.x, size.x), clip(origin.y, inverse.y, size.y);
    clip(origin.z, inverse.z, size.z);
    if (!(t < last)) return {t_max, 0.0f, 0.0f, true};
  }
  const Vec3 begin = add_scaled(origin, t, direction);
  std::uint32_t x = detail::clamp_voxel(floorf(begin.x), grid.cells[0]),
                y = detail::clamp_voxel(floorf(begin.y), grid.cells[1]),
                z = detail::clamp_voxel(floorf(begin.z), grid.cells[2]);
  // Outermost cells have no end outwards.
  const auto end_of = [](std::uint32_t cell, std::uint32_t count, float from, float inverse_way) {
    const bool ends = inverse_way > 0.0f ? cell + 1 < count : inverse_way < 0.0f && cell > 0;
    const float wall = static_cast<float>(cell + (inverse_way > 0.0f ? 1 : 0));
    return ends ? multiply_rounded(wall - from, inverse_way) : infinite_distance;
  };
  Vec3 end(end_of(x, grid.cells[0], origin.x, inverse.x),
           end_of(y, grid.cells[1], origin.y, inverse.y),
           end_of(z, grid.cells[2], origin.z, inverse.z));
  float depth = 0.0f;
  for (;;) {
    const float cell_end = fmaxf(fminf(fminf(end.x, end.y), fminf(end.z, last)), t);
    const float majorant =
        grids.majorants[grid.first_cell + x + grid.cells[0] * (y + grid.cells[1] * z)];
    const float deeper = fused_multiply_add(majorant, cell_end - t, depth);
    if (deeper > depth_wanted) {
      t = fminf(t + divide(depth_wanted - depth, majorant), cell_end);
      return {t, depth_wanted, majorant, false};
    }
    depth = fminf(deeper, infinite_distance);
    t = cell_end;
    if (t >= last) return {t_max, depth, majorant, true};
    if (end.x <= end.y && end.x <= end.z) {
      inverse.x > 0.0f ? ++x : --x;
      end.x = end_of(x, grid.cells[0], origin.x, inverse.x);
    } else if (end.y <= end.z) {
      inverse.y > 0.0f ? ++y : --y;
      end.y = end_of(y, grid.cells[1], origin.y, inverse.y);
    } else {
      inverse.z > 0.0f ? ++z : --z;
      end.z = end_of(z, grid.cells[2], origin.z, inverse.z);
    }
  }
}

}  // namespace pt
