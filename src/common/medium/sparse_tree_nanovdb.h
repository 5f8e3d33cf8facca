// Voxels of sparse grids, by NanoVDB's accessor. NanoVDB's trees of floats, quantized or not, have
// the same nodes but for their leaves. The loader writes into each leaf how many bits a value has,
// where NanoVDB writes it for leaves of the type FpN, so that all are read as such trees.
#pragma once

#include <nanovdb/NanoVDB.h>

#include "common/medium/volume_grid.h"

namespace pt {

using SparseRoot = nanovdb::NanoRoot<nanovdb::FpN>;
using SparseLeaf = nanovdb::NanoLeaf<nanovdb::FpN>;
static_assert(sizeof(SparseLeaf) == 96 && sizeof(nanovdb::NanoLeaf<float>) == 96 + 512 * 4);

inline constexpr std::uint32_t log2_float_bits = 5;

/// Voxel n of a leaf: z varies fastest. NanoVDB's own functions may be compiled to a fused
/// multiplication and addition, which have other bits than on the CPU; and an inactive voxel is 0.
PT_HD float value_in(const SparseLeaf& leaf, std::uint32_t n) {
  const auto& head = *leaf.data();
  const auto* const words = reinterpret_cast<const std::uint32_t*>(&leaf + 1);
  const std::uint32_t log2_bits = head.mFlags >> 5;
  if (log2_bits == log2_float_bits) return bits_to_float(words[n]);
  if (!head.mValueMask.isOn(n)) return 0.0f;
  const std::uint32_t bit = n << log2_bits, mask = (1u << (1u << log2_bits)) - 1;
  const auto code = static_cast<float>(words[bit >> 5] >> (bit & 31) & mask);
  return code * head.mQuantum + head.mMinimum;
}

/// The values of eight voxels: x varies fastest, then y.
PT_HD void read_corners(const SparseBlock* root, const std::int32_t (&x)[2],
                        const std::int32_t (&y)[2], const std::int32_t (&z)[2],
                        float (&values)[8]) {
  using nanovdb::Coord;
  const nanovdb::DefaultReadAccessor<nanovdb::FpN> tree(*reinterpret_cast<const SparseRoot*>(root));
  const auto place = [&](int c) { return Coord(x[c & 1], y[c >> 1 & 1], z[c >> 2]); };
  const auto across = static_cast<std::uint32_t>((x[0] ^ x[1]) | (y[0] ^ y[1]) | (z[0] ^ z[1]));
  const SparseLeaf* leaf = tree.probeLeaf(place(0));
  if (across < 8) {  // all in one leaf or tile
    const float tile = leaf != nullptr ? 0.0f : tree.getValue(place(0));
    PT_UNROLL(8)
    for (int c = 0; c < 8; ++c) {
      values[c] = leaf != nullptr ? value_in(*leaf, SparseLeaf::CoordToOffset(place(c))) : tile;
    }
    return;
  }
  PT_UNROLL(1)
  for (int c = 0; c < 8; ++c) {
    leaf = tree.probeLeaf(place(c));
    values[c] = leaf != nullptr ? value_in(*leaf, SparseLeaf::CoordToOffset(place(c)))
                                : tree.getValue(place(c));
  }
}

}  // namespace pt
