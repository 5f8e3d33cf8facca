// Values of a medium's grids at points: trilinear between voxels, of an array or of a NanoVDB tree.
#pragma once

#include <tables/sparse_tree.inc>

#include "common/medium/medium.h"

namespace pt {
namespace detail {

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

/// The voxels around a coordinate where the grid interpolates, else twice that in which it is.
PT_HD VoxelPair voxels_at(const VolumeGrid& grid, int axis, float unit) {
  VoxelPair pair(unit, grid.size[axis]);
  if (grid.interpolates == 0) {
    pair.low = pair.high =
        clamp_voxel(floorf(unit * static_cast<float>(grid.size[axis])), grid.size[axis]);
    pair.between = 0.0f;
  }
  return pair;
}

/// The value of a sparse grid at a point of its cube, with the bits of a dense one. Out of line, so
/// that kernels keep the registers that they need for dense grids; by pointers, not by the scene.
PT_NOINLINE inline Color sample_sparse(const SparseBlock* root, const float* colors,
                                       const VolumeGrid* grid, Vec3 p) {
  const VoxelPair x = voxels_at(*grid, 0, p.x), y = voxels_at(*grid, 1, p.y),
                  z = voxels_at(*grid, 2, p.z);
  const std::int32_t* const first = reinterpret_cast<const SparseHead*>(root - 1)->low;
  const auto places = [&](int axis, const VoxelPair& pair, std::int32_t(&coordinates)[2]) {
    coordinates[0] = first[axis] + static_cast<std::int32_t>(pair.low);
    coordinates[1] = first[axis] + static_cast<std::int32_t>(pair.high);
  };
  std::int32_t i[2], j[2], k[2];
  places(0, x, i), places(1, y, j), places(2, z, k);
  float v[8];
  read_corners(root, i, j, k, v);
  const auto interpolated = [&](auto&& value) {
    const auto row = [&](int c) { return interpolate(value(v[c]), value(v[c + 1]), x.between); };
    return interpolate(interpolate(row(0), row(2), y.between),
                       interpolate(row(4), row(6), y.between), z.between);
  };
  if (grid->channels == 1) return Color(interpolated([](float value) { return value; }));
  return interpolated([&](float index) {
    const float* const color = colors + 3 * static_cast<std::size_t>(float_to_bits(index));
    return Color(color[0], color[1], color[2]);
  });
}

}  // namespace detail

/// The grid's value at a point of the world; a single channel is grey. Code for a GPU looks sparse
/// grids up only with `has_sparse`, since the call costs registers; code for a CPU always does.
template <bool has_sparse = false>
PT_HD Color sample_grid(const VolumeGrids& grids, const VolumeGrid& grid, const Vec3& point) {
  const Vec3 p = grid.to_unit.point(point);
  const float* const values = grids.values + grid.first;
  if constexpr (has_sparse || !runs_on_gpu) {
    if (grid.root != 0) return detail::sample_sparse(grids.nodes + grid.root, values, &grid, p);
  }
  if (grid.channels == 1) {
    return Color(detail::value_at(grid, p, [&](std::uint32_t i) { return values[i]; }));
  }
  return detail::value_at(grid, p, [&](std::uint32_t i) {
    return Color(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
  });
}

/// The medium's albedo at a point.
template <bool has_sparse = false>
PT_HD Color albedo_at(const VolumeGrids& grids, const Medium& medium, const Vec3& point) {
  if (medium.albedo_grid == no_grid) return medium.albedo;
  return medium.albedo * sample_grid<has_sparse>(grids, grids.grids[medium.albedo_grid], point);
}

/// The radiance of the absorbing matter at a point.
template <bool has_sparse = false>
PT_HD Color emission_at(const VolumeGrids& grids, const Medium& medium, const Vec3& point) {
  if (medium.emission_grid == no_grid) return medium.emission;
  return medium.emission * sample_grid<has_sparse>(grids, grids.grids[medium.emission_grid], point);
}

}  // namespace pt
