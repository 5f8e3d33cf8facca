// What the tiles of a scan over the tags (scan_tags.cuh) tell each other.
#pragma once

#include <cstdint>

namespace pt {

/// Counts for two queues as one number, so that one addition adds both: the first queue's in bits 0
/// to 30, the second one's in bits 32 to 62. Slots are fewer than 2^31.
using TagCounts = unsigned long long;

/// All zero before the first launch; every launch leaves it right for the next one, which must have
/// as many tiles.
struct TileState {
  TagCounts* counts = nullptr;       ///< [tile]: its counts, and tile_ready
  std::uint32_t* tickets = nullptr;  ///< tiles that have begun; 0 again when all have
};

}  // namespace pt
