// The kernel around a stage: threads take the slots of its queue in turn and send them on.
#pragma once

#include "common/device/cuda/bind_scene.cuh"
#include "common/device/cuda/stage_stamp.cuh"
#include "wavefront/wave_buffers.h"

namespace pt {

/// Appends slots to up to `streams` queues: a vote per warp, a sum per block, and one atomic
/// addition per block and queue. All threads of the block call append() together.
template <int streams>
class BlockAppender {
 public:
  struct Shared {
    std::uint32_t index[2][streams][32];  // [buffer][stream][warp]: counts, then indices
  };

  __device__ explicit BlockAppender(Shared& shared)
      : shared_(shared), lane_(threadIdx.x & 31), warp_(threadIdx.x >> 5) {
    const std::uint32_t threads = blockDim.x - 32 * warp_;
    warp_mask_ = threads >= 32 ? 0xffffffffu : (1u << threads) - 1;
  }

  /// Where `wanted[s]`, puts `slot` at the end of queues[s], whose length is *ends[s].
  __device__ void append(const bool (&wanted)[streams], std::uint32_t slot,
                         std::uint32_t* const (&queues)[streams],
                         std::uint32_t* const (&ends)[streams]) {
    auto& index = shared_.index[buffer_];
    std::uint32_t votes[streams];
    for (int s = 0; s < streams; ++s) {
      votes[s] = __ballot_sync(warp_mask_, wanted[s]);
      if (lane_ == 0) index[s][warp_] = __popc(votes[s]);
    }
    __syncthreads();
    // A thread per queue; one for several where a block has fewer threads than queues.
    for (int s = threadIdx.x; s < streams; s += blockDim.x) reserve(index[s], pick(ends, s));
    __syncthreads();
    for (int s = 0; s < streams; ++s) {
      if (wanted[s]) {
        queues[s][index[s][warp_] + __popc(votes[s] & ((1u << lane_) - 1))] = slot;
      }
    }
    buffer_ ^= 1;  // the next call must not overwrite what slower warps still read
  }

 private:
  /// ends[s], chosen by arithmetic: indices and even branches end as an array in local memory,
  /// which every thread writes.
  __device__ static std::uint32_t* pick(std::uint32_t* const (&ends)[streams], int s) {
    std::uint64_t end = 0;
    PT_UNROLL(3)
    for (int k = 0; k < streams; ++k) {
      end |= reinterpret_cast<std::uint64_t>(ends[k]) & -static_cast<std::uint64_t>(s == k);
    }
    return reinterpret_cast<std::uint32_t*>(end);
  }

  __device__ static void reserve(std::uint32_t (&votes)[32], std::uint32_t* end) {
    const int warps = (blockDim.x + 31) / 32;
    std::uint32_t total = 0;
    for (int w = 0; w < warps; ++w) total += votes[w];
    std::uint32_t next = total > 0 ? atomicAdd(end, total) : 0;
    for (int w = 0; w < warps; ++w) {
      const std::uint32_t count = votes[w];
      votes[w] = next;
      next += count;
    }
  }

  Shared& shared_;
  int lane_, warp_;
  std::uint32_t warp_mask_;
  int buffer_ = 0;
};

/// Where all of these queues are there.
template <StageId... ids, class Appender>
__device__ void append_each(Appender& appender, const StageQueues& queues, bool done, StageId to,
                            std::uint32_t slot) {
  appender.append({(done && to == ids)...}, slot, {queues.next[queue_of<ids>]...},
                  {(queues.waiting + queue_of<ids>)...});
}

/// Sends what a block has finished to the next queues. Called by all of its threads, with `done` in
/// those that had a slot.
template <class Stage, class Appender>
__device__ void append_next(Appender& appender, const StageQueues& queues, bool done, Next next,
                            std::uint32_t slot) {
  constexpr StageOutcomes outcomes = Stage::outcomes;
  constexpr int a = queue_index(outcomes.to[0]), b = queue_index(outcomes.to[1]);
  const bool to_a = done && next.to == outcomes.to[0];
  constexpr int shadow = queue_of<StageId::shadow>;
  if (queues.next[a] == nullptr && queues.next[b] == nullptr) return;
  const bool to_b = done && !to_a && queues.next[b] != nullptr;
  if constexpr (outcomes.extra() > 0) {
    static_assert(!outcomes.casts_shadow_rays);
    if constexpr (outcomes.extra() == 1) {
      append_each<outcomes.to[0], outcomes.to[1], outcomes.more[0]>(appender, queues, done, next.to,
                                                                    slot);
    } else {
      append_each<outcomes.to[0], outcomes.to[1], outcomes.more[0], outcomes.more[1]>(
          appender, queues, done, next.to, slot);
    }
  } else if constexpr (outcomes.casts_shadow_rays) {
    appender.append({to_a, to_b, done && next.shadow}, slot,
                    {queues.next[a], queues.next[b], queues.next[shadow]},
                    {queues.waiting + a, queues.waiting + b, queues.waiting + shadow});
  } else {
    appender.append({to_a, to_b}, slot, {queues.next[a], queues.next[b]},
                    {queues.waiting + a, queues.waiting + b});
  }
}

/// Most threads of a block of a stage.
template <class Stage>
constexpr int block_max() {
  if constexpr (requires { Stage::block_max; }) return Stage::block_max;
  return 1024;
}

/// The queue's length is read on the device, so the grid has a fixed size and loops.
template <class Stage, SceneMemory memory>
__global__ void __launch_bounds__(block_max<Stage>())
    stage_kernel(const __grid_constant__ SceneStorage<memory> storage,
                 const __grid_constant__ Stage stage, const __grid_constant__ StageQueues queues,
                 StageClock* clock) {
#if CUDART_VERSION >= 13000
  // Registers that do not suffice spill into shared memory, not into L1, which writes them through.
  // Not beside shared memory whose size the host chooses.
  if constexpr (Stage::id == StageId::shade_surface && memory != SceneMemory::shared)
    asm volatile(".pragma \"enable_smem_spilling\";");
#endif
  constexpr int extra = Stage::outcomes.casts_shadow_rays ? 1 : Stage::outcomes.extra();
  using Appender = BlockAppender<2 + extra>;
  __shared__ typename Appender::Shared shared;
  stamp_first_thread(clock, id_of(stage));
  const std::uint32_t count = *queues.count;
  if (blockIdx.x * blockDim.x >= count) return;
  const Scene& scene = storage.bind();
  const std::uint32_t* const slots = queues.begin();
  Appender appender(shared);
  constexpr StageId own_tag = stage_info(Stage::id).queue;
  const bool appends = queues.appends;
  const bool has_queue = queues.input == StageInput::queue;
  const bool looks_at_tags = queues.input == StageInput::tags;
  for (std::uint32_t base = blockIdx.x * blockDim.x; base < count; base += gridDim.x * blockDim.x) {
    const std::uint32_t i = base + threadIdx.x;
    std::uint32_t slot = i;
    bool mine = i < count;
    if (mine && has_queue) slot = slots[i];
    if (mine && looks_at_tags) mine = queues.tags[slot] == own_tag;
    Next next{};
    if (mine) next = stage(scene, slot, i);
    if (appends) {
      if constexpr (Stage::outcomes.sends) append_next<Stage>(appender, queues, mine, next, slot);
    } else if (mine) {
      queues.tags[slot] = next.to;
      if constexpr (Stage::outcomes.casts_shadow_rays) {
        queues.shadow_tags[slot] = next.shadow ? StageId::shadow : free_slot;
      }
    }
  }
}

}  // namespace pt
