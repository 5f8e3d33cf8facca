// How blocks share paths, and where those lie that have begun elsewhere.
#pragma once

#include "common/block_wavefront/path_slot.h"
#include "common/transport/extra_state.h"

namespace pt {

/// How blocks share the paths of a batch.
struct PathShare {
  std::uint32_t* next;    ///< paths that have been taken
  std::uint32_t at_once;  ///< that a block may take: else the first ones would take small batches
  int slots_per_thread;   ///< fewer where a block's memory is small
};

/// The slots of all blocks, in the device's memory: [blocks][per_block].
struct BlockSlots {
  PathSlot* paths;
  PathRecord* media;  ///< of the paths (pack_medium); only in scenes with media
  std::uint32_t per_block;
  ExtraState extra = {};  ///< of the paths, side by side; only with --path-bytes

  /// Those of one block.
  PT_HD BlockSlots of_block(std::uint32_t block) const {
    const std::size_t first = std::size_t{block} * per_block;
    ExtraState own = extra;
    own.records += first * own.stride;
    return {paths + first, media != nullptr ? media + first : nullptr, per_block, own};
  }
};

/// Paths between two of their rays, neighbours in one block.
struct BegunPaths {
  BlockSlots slots;
  std::uint32_t count;
  std::uint32_t per_block;  ///< at most slots.per_block

  static BegunPaths divide(const BlockSlots& slots, std::uint32_t count, std::uint32_t blocks) {
    return {slots, count, (count + blocks - 1) / blocks};
  }

  /// Where the k-th of them lies.
  PT_HD std::size_t place(std::uint32_t k) const {
    return std::size_t{k / per_block} * slots.per_block + k % per_block;
  }
  /// Those of a block, which are in its first slots.
  PT_HD std::uint32_t count_in(std::uint32_t block) const {
    const std::uint32_t first = block * per_block;
    const std::uint32_t left = first < count ? count - first : 0;
    return left < per_block ? left : per_block;
  }
};

}  // namespace pt
