// Regular grids of values that vary in a medium, and their bounds, which make empty space cheap.
#pragma once

#include "common/geometry/ray.h"
#include "common/math/transform.h"

namespace pt {

inline constexpr std::uint32_t no_grid = 0xffffffffu;

/// A grid's place in space and in memory. Beyond its cube the outermost voxels continue, but not
/// along an infinite ray.
struct alignas(16) VolumeGrid {
  Affine to_unit;                ///< from the world to the cube [0, 1]^3, which the voxels fill
  std::uint32_t size[3] = {};    ///< voxels, each at least 1
  std::uint32_t first = 0;       ///< index of its first value; x varies fastest, then y
  std::uint32_t cells[3] = {};   ///< number of cells of majorants; 0: none
  std::uint32_t first_cell = 0;  ///< index of the first of them, in the same order
  std::uint32_t channels = 1;    ///< 1, or 3 that stand side by side
  std::uint32_t interpolates =
      1;                   ///< trilinear between the middles of voxels; else constant in each
  std::uint32_t ends = 0;  ///< its outermost voxels are 0: it is empty beyond its cube
  std::uint32_t unused = 0;
};

/// The grids of a scene.
struct VolumeGrids {
  const VolumeGrid* grids = nullptr;
  const float* values = nullptr;
  const float* majorants = nullptr;  ///< per cell, an upper bound of the grid's values in it
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

}  // namespace pt
