// The kernel around a stage: threads take the slots of its queue in turn and send them on.
#pragma once

#include "common/device/bind_scene.cuh"
#include "common/device/stage_stamp.cuh"
#include "wavefront/wavefront.h"

namespace pt {

/// Appends slots to up to `streams` queues for a block of threads. Warps put theirs side by side in
/// shared memory, and do not wait for each other; when the block has taken as many as fit there,
/// flush() reserves their places with one atomic addition per queue.
template <int streams>
class BlockAppender {
 public:
  static constexpr std::uint32_t capacity = 1024;  ///< slots of a queue between two flushes

  struct Shared {
    std::uint32_t slots[streams][capacity];
    std::uint32_t count[streams];  ///< of them
    std::uint32_t total[streams];  ///< of those that are flushed
    std::uint32_t place[streams];  ///< in the queue, of the first of these
  };

  /// Called by all threads of the block.
  __device__ explicit BlockAppender(Shared& shared) : shared_(shared) {
    for (int s = threadIdx.x; s < streams; s += blockDim.x) shared_.count[s] = 0;
    __syncthreads();
  }

  /// Where `wanted[s]`, puts `slot` into queue s. Called by whole warps, and no more often than
  /// `capacity` / threads of the block between two flushes.
  __device__ void append(const bool (&wanted)[streams], std::uint32_t slot) {
    const std::uint32_t lane = threadIdx.x & 31, before = threadIdx.x - lane;
    const std::uint32_t threads = blockDim.x - before;
    const std::uint32_t warp_mask = threads >= 32 ? 0xffffffffu : (1u << threads) - 1;
    for (int s = 0; s < streams; ++s) {
      const std::uint32_t votes = __ballot_sync(warp_mask, wanted[s]);
      std::uint32_t place = 0;
      if (lane == 0 && votes != 0) place = atomicAdd(&shared_.count[s], __popc(votes));
      place = __shfl_sync(warp_mask, place, 0) + __popc(votes & ((1u << lane) - 1));
      if (wanted[s]) shared_.slots[s][place] = slot;
    }
  }

  /// Puts all at the ends of the queues, whose lengths are *ends[s]. Called by all threads of the
  /// block together.
  __device__ void flush(std::uint32_t* const (&queues)[streams],
                        std::uint32_t* const (&ends)[streams]) {
    __syncthreads();
    // A thread per queue; one for several where a block has fewer threads than queues.
    for (int s = threadIdx.x; s < streams; s += blockDim.x) {
      const std::uint32_t total = shared_.total[s] = shared_.count[s];
      if (total > 0) shared_.place[s] = atomicAdd(pick(ends, s), total);
      shared_.count[s] = 0;
    }
    __syncthreads();
    for (int s = 0; s < streams; ++s) {
      for (std::uint32_t i = threadIdx.x; i < shared_.total[s]; i += blockDim.x) {
        queues[s][shared_.place[s] + i] = shared_.slots[s][i];
      }
    }
    __syncthreads();  // the next ones must not overwrite what slower warps still read
  }

 private:
  /// ends[s] without an array in local memory.
  __device__ static std::uint32_t* pick(std::uint32_t* const (&ends)[streams], int s) {
    std::uint32_t* end = ends[0];
    for (int k = 1; k < streams; ++k) {
      if (s == k) end = ends[k];
    }
    return end;
  }

  Shared& shared_;
};

/// The queues behind a stage, and how a block sends slots to them; nothing for a stage that sends
/// none.
template <class Stage, bool sends = Stage::outcomes.sends>
class NextQueues {
 public:
  struct Shared {};
  __device__ NextQueues(Shared&, const StageQueues&) {}
  __device__ static constexpr std::uint32_t turns_max() { return 1; }
  __device__ void append(bool, Next, std::uint32_t) {}
  __device__ void flush() {}
};

template <class Stage>
class NextQueues<Stage, true> {
  static constexpr StageOutcomes outcomes = Stage::outcomes;
  static constexpr int a = queue_index(outcomes.to[0]), b = queue_index(outcomes.to[1]),
                       shadow = queue_of<StageId::shadow>;
  using Appender = BlockAppender<outcomes.casts_shadow_rays ? 3 : 2>;

 public:
  using Shared = typename Appender::Shared;

  __device__ NextQueues(Shared& shared, const StageQueues& queues)
      : appender_(shared), queues_(queues) {}

  /// How often each thread may append before the block flushes.
  __device__ static std::uint32_t turns_max() { return Appender::capacity / blockDim.x; }

  /// Called by whole warps, with `done` in threads that had a slot.
  __device__ void append(bool done, Next next, std::uint32_t slot) {
    if (nobody_waits()) return;
    const bool to_a = done && next.to == outcomes.to[0];
    const bool to_b = done && !to_a && queues_.next[b] != nullptr;
    if constexpr (outcomes.casts_shadow_rays) {
      appender_.append({to_a, to_b, done && next.shadow}, slot);
    } else {
      appender_.append({to_a, to_b}, slot);
    }
  }

  /// Called by all threads of the block together.
  __device__ void flush() {
    if (nobody_waits()) return;
    if constexpr (outcomes.casts_shadow_rays) {
      appender_.flush({queues_.next[a], queues_.next[b], queues_.next[shadow]},
                      {queues_.waiting + a, queues_.waiting + b, queues_.waiting + shadow});
    } else {
      appender_.flush({queues_.next[a], queues_.next[b]},
                      {queues_.waiting + a, queues_.waiting + b});
    }
  }

 private:
  __device__ bool nobody_waits() const {
    return queues_.next[a] == nullptr && queues_.next[b] == nullptr;
  }

  Appender appender_;
  const StageQueues& queues_;
};

/// Most threads of a block of a stage.
template <class Stage>
constexpr int block_max() {
  if constexpr (requires { Stage::block_max; }) return Stage::block_max;
  return 1024;
}

/// How many turns a block takes for a tile of the queue: at most `most`, and as many in its last
/// tile as in the others.
__device__ inline std::uint32_t turns_of_tile(std::uint32_t count, std::uint32_t most) {
  const std::uint32_t all = gridDim.x * blockDim.x, turns = (count + all - 1) / all;
  const std::uint32_t tiles = max(1u, (turns + most - 1) / most);
  return max(1u, (turns + tiles - 1) / tiles);
}

/// The queue's length is read on the device, so the grid has a fixed size and loops: a block takes
/// a tile of the queue at a time, blockDim.x slots in each turn.
template <class Stage, SceneMemory memory>
__global__ void __launch_bounds__(block_max<Stage>())
    stage_kernel(const __grid_constant__ SceneStorage<memory> storage,
                 const __grid_constant__ Stage stage, const __grid_constant__ StageQueues queues,
                 StageClock* clock) {
  using Queues = NextQueues<Stage>;
  __shared__ typename Queues::Shared shared;
  stamp_first_thread(clock, Stage::id);
  const std::uint32_t count = *queues.count;
  const std::uint32_t tile = turns_of_tile(count, Queues::turns_max()) * blockDim.x;
  if (blockIdx.x * tile >= count) return;
  const Scene scene = storage.bind();
  const std::uint32_t* const slots = queues.begin();
  Queues next_queues(shared, queues);
  constexpr StageId own_tag = stage_info(Stage::id).queue;
  const bool appends = queues.appends;
  const bool has_queue = queues.input == StageInput::queue;
  const bool looks_at_tags = queues.input == StageInput::tags;
  for (std::uint32_t begin = blockIdx.x * tile; begin < count; begin += gridDim.x * tile) {
    const std::uint32_t end = min(begin + tile, count);
    for (std::uint32_t turn = begin; turn < end; turn += blockDim.x) {
      const std::uint32_t i = turn + threadIdx.x;
      std::uint32_t slot = i;
      bool mine = i < count;
      if (mine && has_queue) slot = slots[i];
      if (mine && looks_at_tags) mine = queues.tags[slot] == own_tag;
      Next next{};
      if (mine) next = stage(scene, slot, i);
      if (appends) {
        next_queues.append(mine, next, slot);
      } else if (mine) {
        queues.tags[slot] = next.to;
        if constexpr (Stage::outcomes.casts_shadow_rays) {
          queues.shadow_tags[slot] = next.shadow ? StageId::shadow : free_slot;
        }
      }
    }
    if (appends) next_queues.flush();
  }
}

}  // namespace pt
