// Stratified numbers: a pixel's samples take the cells of a grid in random order, one each, a grid
// for every pair of numbers of a block (pbrt-v4, section 8.5).
#pragma once

#include "common/sampling/remix.h"
#include "common/sampling/warp.h"

namespace pt {

/// The cells of a grid for `count` samples, as square as can be; what is left over is not
/// stratified.
struct StrataGrid {
  std::uint32_t columns = 1, rows = 1;

  PT_HD std::uint32_t cells() const { return columns * rows; }
};

inline StrataGrid make_strata_grid(std::uint32_t count) {
  std::uint32_t columns = 1;
  while (std::uint64_t{columns + 1} * (columns + 1) <= count) ++columns;
  return {columns, count / columns};
}

/// A random permutation of [0, count), for each seed another: bijections of the next power of two
/// are applied until the value is below count (cycle walking, as Kensler 2013, 'Correlated
/// multi-jittered sampling').
PT_HD std::uint32_t permute(std::uint32_t i, std::uint32_t count, std::uint32_t seed) {
  std::uint32_t mask = count - 1;
  mask |= mask >> 1, mask |= mask >> 2, mask |= mask >> 4, mask |= mask >> 8, mask |= mask >> 16;
  const std::uint32_t shift = mask > 0x3fu ? 4u : mask > 7u ? 2u : 1u;
  do {
    PT_UNROLL(1)
    for (std::uint32_t round = 0; round < 4; ++round) {  // fewer leave pairs of small grids uneven
      const std::uint32_t key = remix(seed + round * 0x9e3779b9u);
      i = (i ^ key) * (key >> 8 | 1u) & mask;
      i ^= i >> shift;
      i = (i + (key >> 20)) * (key >> 12 | 1u) & mask;
      i ^= i >> 1;
    }
  } while (i >= count);
  return i;
}

/// `u` in its cell. `sample` below the grid's number of cells.
PT_HD Vec2 stratify(const Vec2& u, const StrataGrid& grid, std::uint32_t sample,
                    std::uint32_t seed) {
  const std::uint32_t cell = permute(sample, grid.cells(), seed);
  const std::uint32_t row = cell / grid.columns, column = cell - row * grid.columns;
  return {
      fminf((static_cast<float>(column) + u.x) / static_cast<float>(grid.columns), one_minus_ulp),
      fminf((static_cast<float>(row) + u.y) / static_cast<float>(grid.rows), one_minus_ulp)};
}

/// The four numbers of a block: `u`, independent for each sample, in the cells that `seeds` (the
/// same for all samples of a pixel) give this sample. Samples after the last cell begin a new grid.
PT_HD Vec4 stratified_block(const Vec4& u, const StrataGrid& grid, std::uint32_t count,
                            std::uint32_t sample, const Uint4& seeds) {
  const std::uint32_t round = sample / count, index = sample - round * count;
  if (index >= grid.cells()) return u;
  const Vec2 a = stratify({u.x, u.y}, grid, index, seeds.x + round * seeds.z);
  const Vec2 b = stratify({u.z, u.w}, grid, index, seeds.y + round * seeds.w);
  return {a.x, a.y, b.x, b.y};
}

}  // namespace pt
