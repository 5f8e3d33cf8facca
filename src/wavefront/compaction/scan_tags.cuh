// Queues out of tags in one launch that reads every tag once, in ascending order of slots.
//
// The tags are divided into tiles, one for each block. A thread compares 32 tags at once and keeps
// the bits that match; the block adds up its bits, publishes the sums, and waits for those of all
// tiles before its own: together they are the indices at which its slots begin. Then each warp
// writes its slots independently, through shared memory, so that the stores are wide and coalesced.
// It is the scan by decoupled look-back (Merrill and Garland 2016, 'Single-pass Parallel Prefix
// Scan with Decoupled Look-back') without the prefixes that tiles publish there: tiles are as large
// as the items allow, hence few, and a block waits for no more than the tiles that read at the same
// time.
#pragma once

#include "common/device/cuda/stage_stamp.cuh"
#include "wavefront/compaction/compaction.h"
#include "wavefront/compaction/tag_masks.h"
#include "wavefront/compaction/tile_state.h"

namespace pt {

/// Turns over with every launch: a tile is ready whose bit is no more what it was.
inline constexpr TagCounts tile_ready = 0x80000000u;

inline constexpr int scan_threads = 512;                     ///< of a tile
inline constexpr std::uint32_t row_slots = 32 * mask_slots;  ///< of a row: a mask for each lane

/// Slots of a tile whose warps have so many rows each.
constexpr std::uint32_t tile_slots(int rows) { return scan_threads / 32 * rows * row_slots; }

__device__ inline TagCounts warp_sum(TagCounts x) {
  for (int step = 16; step > 0; step /= 2) x += __shfl_xor_sync(0xffffffffu, x, step);
  return x;
}

/// 32 tags from `first` on, a multiple of 32; idle for slots that there are not.
__device__ inline void load_tags(const CompactionRequest& request, std::uint32_t first,
                                 std::uint32_t (&words)[8]) {
  if (first + mask_slots <= request.slot_count) {
    const uint4* const wide = reinterpret_cast<const uint4*>(request.tags + first);
    const uint4 low = __ldcs(wide), high = __ldcs(wide + 1);  // each is read once
    words[0] = low.x, words[1] = low.y, words[2] = low.z, words[3] = low.w;
    words[4] = high.x, words[5] = high.y, words[6] = high.z, words[7] = high.w;
    return;
  }
  for (std::uint32_t w = 0; w < 8; ++w) {
    words[w] = 0;
    for (std::uint32_t byte = 0; byte < 4; ++byte) {
      const std::uint32_t slot = first + 4 * w + byte;
      const StageId tag = slot < request.slot_count ? request.tags[slot] : StageId::idle;
      words[w] |= static_cast<std::uint32_t>(tag) << 8 * byte;
    }
  }
}

/// The slots of a row in shared memory, and up to 3 elements before and behind them.
struct alignas(16) RowStage {
  std::uint16_t slots[row_slots + 8];
};

/// Writes the row's slots whose bits are set, the lowest to queue[index], and returns how many they
/// are. `first`: slot of the first lane's bit 0. All threads of the warp together.
__device__ inline std::uint32_t write_row(std::uint32_t* queue, std::uint32_t index,
                                          std::uint32_t first, std::uint32_t mask,
                                          RowStage& stage) {
  const std::uint32_t lane = threadIdx.x & 31;
  const std::uint32_t own = __popc(mask);
  std::uint32_t end = own;
  for (std::uint32_t step = 1; step < 32; step *= 2) {
    const std::uint32_t lower = __shfl_up_sync(0xffffffffu, end, step);
    if (lane >= step) end += lower;
  }
  const std::uint32_t total = __shfl_sync(0xffffffffu, end, 31);
  // Four neighbours of the stage make one aligned store.
  std::uint32_t* const to = queue + index;
  const std::uint32_t shift =
      static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(to) / 4 % 4);
  __syncwarp();  // others may still read the last row
  for (std::uint32_t at = shift + end - own; mask != 0; mask &= mask - 1) {
    stage.slots[at++] = static_cast<std::uint16_t>(mask_slots * lane + lowest_bit(mask));
  }
  __syncwarp();
  for (std::uint32_t i = 4 * lane; i < shift + total; i += 4 * 32) {
    const ushort4 four = *reinterpret_cast<const ushort4*>(&stage.slots[i]);
    const uint4 slots = {first + four.x, first + four.y, first + four.z, first + four.w};
    const auto is_inside = [&](std::uint32_t index) {
      return index >= shift && index < shift + total;
    };
    if (is_inside(i) && is_inside(i + 3)) {
      __stcs(reinterpret_cast<uint4*>(to - shift + i), slots);
    } else {
      if (is_inside(i)) to[i - shift] = slots.x;
      if (is_inside(i + 1)) to[i + 1 - shift] = slots.y;
      if (is_inside(i + 2)) to[i + 2 - shift] = slots.z;
      if (is_inside(i + 3)) to[i + 3 - shift] = slots.w;
    }
  }
  return total;
}

/// Serves the request; `queues`: wanted, 1 or 2. A block per tile; the tags begin at a multiple of
/// 16 bytes. `clock` may be null.
template <int queues, int rows>
__global__ void __launch_bounds__(scan_threads)
    scan_tags(const __grid_constant__ CompactionRequest request, TileState state,
              StageClock* clock) {
  constexpr std::uint32_t warps = scan_threads / 32;
  __shared__ RowStage stages[warps];
  __shared__ TagCounts counts_of_warp[warps], before_tile[warps], shared_bit;
  __shared__ std::uint32_t shared_tile;
  if (clock != nullptr) stamp_first_thread(clock, StageId::compact);
  const std::uint32_t lane = threadIdx.x & 31, warp = threadIdx.x >> 5;

  // A tile waits only for tiles that have begun, in whatever order the device starts blocks.
  if (threadIdx.x == 0) shared_tile = atomicInc(state.tickets, gridDim.x - 1);
  __syncthreads();
  const std::uint32_t tile = shared_tile;
  volatile TagCounts* const tiles = state.counts;
  TagCounts bit = 0;  // of tiles that are ready in this launch
  if (threadIdx.x == 0) bit = ~tiles[tile] & tile_ready;

  const std::uint32_t warp_first = (tile * warps + warp) * rows * row_slots;
  std::uint32_t masks[rows][queues];
  TagCounts count = 0;
  PT_UNROLL(8)
  for (int r = 0; r < rows; ++r) {
    std::uint32_t words[8];
    load_tags(request, warp_first + r * row_slots + mask_slots * lane, words);
    PT_UNROLL(2)
    for (int q = 0; q < queues; ++q) {
      masks[r][q] = match_mask(words, request.wanted[q]);
      count += static_cast<TagCounts>(__popc(masks[r][q])) << 32 * q;
    }
  }
  count = warp_sum(count);
  if (lane == 0) counts_of_warp[warp] = count;
  if (threadIdx.x == 0) shared_bit = bit;
  __syncthreads();
  bit = shared_bit;
  if (warp == 0) {
    const TagCounts of_tile = warp_sum(lane < warps ? counts_of_warp[lane] : 0);
    if (lane == 0)
      tiles[tile] = of_tile | bit;  // one word: the bit is never seen without the counts
  }

  TagCounts before = 0;
  for (std::uint32_t t = threadIdx.x; t < tile; t += scan_threads) {
    TagCounts of_tile = tiles[t];
    while ((of_tile & tile_ready) != bit) of_tile = tiles[t];
    before += of_tile & ~tile_ready;
  }
  before = warp_sum(before);
  if (lane == 0) before_tile[warp] = before;
  __syncthreads();
  const TagCounts begin =
      warp_sum((lane < warps ? before_tile[lane] : 0) + (lane < warp ? counts_of_warp[lane] : 0));
  if (tile == gridDim.x - 1 && warp == warps - 1 && lane < queues) {
    request.counts[lane] = static_cast<std::uint32_t>((begin + count) >> 32 * lane);
  }
  PT_UNROLL(2)
  for (int q = 0; q < queues; ++q) {
    auto index = static_cast<std::uint32_t>(begin >> 32 * q);
    PT_UNROLL(8)
    for (int r = 0; r < rows; ++r) {
      index += write_row(request.queues[q], index, warp_first + r * row_slots, masks[r][q],
                         stages[warp]);
    }
  }
}

}  // namespace pt
