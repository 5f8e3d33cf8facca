// Regular grids of values that vary in a medium, and their bounds, which make empty space cheap.
#pragma once

#include <cstddef>

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
  /// A sparse grid is a tree of NanoVDB: the index of the block where its root begins, behind its
  /// SparseHead; 0: dense. With 3 channels its voxels have the bits of an index, from `first` on,
  /// into colours, of which the first is that of empty space.
  std::uint32_t root = 0;
};

/// What a tree consists of: nodes begin at such addresses.
struct alignas(32) SparseBlock {
  std::byte bytes[32];
};

/// What stands before a tree's root.
struct alignas(32) SparseHead {
  std::int32_t low[3];  ///< the tree's coordinates of voxel (0, 0, 0)
};
static_assert(sizeof(SparseHead) == sizeof(SparseBlock));

/// The grids of a scene.
struct VolumeGrids {
  const VolumeGrid* grids = nullptr;
  const float* values = nullptr;
  /// Per cell, an upper bound of the grid's values in it. In a scene with sparse grids an empty
  /// cell has -d instead: all cells that differ from it by less than d along each axis are empty.
  const float* majorants = nullptr;
  const SparseBlock* nodes = nullptr;  ///< of the sparse grids
};

namespace detail {

PT_HD std::uint32_t clamp_voxel(float index, std::uint32_t size) {
  return static_cast<std::uint32_t>(fminf(fmaxf(index, 0.0f), static_cast<float>(size - 1)));
}

}  // namespace detail

}  // namespace pt
