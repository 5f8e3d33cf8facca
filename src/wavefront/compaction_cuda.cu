#include <cub/device/device_partition.cuh>
#include <thrust/iterator/counting_iterator.h>
#include <thrust/iterator/discard_iterator.h>

#include "common/device/cuda_check.h"
#include "common/device/stage_stamp.cuh"
#include "wavefront/compaction_cuda.h"

namespace pt {
namespace {

constexpr int block_threads = 256;
constexpr int warps = block_threads / 32;
constexpr int items = 8;  // slots per thread
constexpr std::uint32_t tile = block_threads * items;

/// CUB's question for each slot. Being asked about slot 0 is also how the clock learns that the
/// compaction has begun: CUB's kernels are not ours to change.
struct HasTag {
  const PathTag* tags;
  PathTag wanted;
  StageClock* clock;

  __device__ bool operator()(std::uint32_t slot) const {
    if (slot == 0 && clock != nullptr) stamp(clock, ClockId::compact);
    return tags[slot] == wanted;
  }
};

cudaError_t partition(void* storage, std::size_t& storage_bytes, const CompactionRequest& request,
                      StageClock* clock, cudaStream_t stream) {
  // Three classes: the first queue, the second, and the slots that wait for neither.
  return cub::DevicePartition::If(
      storage, storage_bytes, thrust::counting_iterator<std::uint32_t>(0), request.queues[0],
      request.queues[1], thrust::discard_iterator<>(), request.counts,
      static_cast<int>(request.slot_count), HasTag{request.tags, request.wanted[0], clock},
      HasTag{request.tags, request.wanted[1], nullptr}, stream);
}

/// A block gathers a tile of slots: each warp votes 32 slots at a time, the block adds up its votes
/// and reserves its places in both queues with one atomic addition each. The last block to finish
/// publishes the counts and clears the cursors for the next call. With `write` false it only counts.
template <bool write>
__global__ void gather_by_arrival(CompactionRequest request, std::uint32_t* cursors,
                                  StageClock* clock) {
  if (clock != nullptr) stamp_first_thread(clock, ClockId::compact);
  __shared__ std::uint32_t votes[2][items * warps];  // then: places before this vote's slots
  __shared__ std::uint32_t base[2];
  const int lane = threadIdx.x & 31, warp = threadIdx.x >> 5;
  std::uint32_t mask[2][items];
  for (int i = 0; i < items; ++i) {
    const std::uint32_t slot = blockIdx.x * tile + i * block_threads + threadIdx.x;
    const bool inside = slot < request.slot_count;
    const PathTag tag = inside ? request.tags[slot] : PathTag{};
    for (int c = 0; c < 2; ++c) {
      mask[c][i] = __ballot_sync(0xffffffffu, inside && tag == request.wanted[c]);
      if (lane == 0) votes[c][i * warps + warp] = __popc(mask[c][i]);
    }
  }
  __syncthreads();
  if (warp < 2) {  // one warp per queue turns its 64 votes into places
    std::uint32_t* row = votes[warp];
    const std::uint32_t a = row[2 * lane], b = row[2 * lane + 1];
    std::uint32_t sum = a + b;
    for (int d = 1; d < 32; d *= 2) {
      const std::uint32_t before = __shfl_up_sync(0xffffffffu, sum, d);
      if (lane >= d) sum += before;
    }
    row[2 * lane] = sum - a - b;
    row[2 * lane + 1] = sum - b;
    if (lane == 31) base[warp] = sum > 0 ? atomicAdd(&cursors[warp], sum) : 0;
  }
  __syncthreads();
  if constexpr (write) {
    for (int i = 0; i < items; ++i) {
      const std::uint32_t slot = blockIdx.x * tile + i * block_threads + threadIdx.x;
      for (int c = 0; c < 2; ++c) {
        if ((mask[c][i] >> lane & 1) == 0) continue;
        const std::uint32_t rank = __popc(mask[c][i] & ((1u << lane) - 1));
        request.queues[c][base[c] + votes[c][i * warps + warp] + rank] = slot;
      }
    }
  }
  if (threadIdx.x == 0) {
    __threadfence();
    if (atomicAdd(&cursors[2], 1) == gridDim.x - 1) {
      for (int c = 0; c < 2; ++c) request.counts[c] = atomicExch(&cursors[c], 0);
      atomicExch(&cursors[2], 0);
    }
  }
}
static_assert(items * warps == 64, "the scan above is of 64 votes");

}  // namespace

CudaCompactor::CudaCompactor(Compaction strategy, std::uint32_t slot_count_max, CudaMemory& memory)
    : strategy_(strategy), slot_count_max_(slot_count_max) {
  if (strategy == Compaction::cub) {
    CompactionRequest request;
    request.slot_count = slot_count_max;
    check_cuda(partition(nullptr, cub_storage_bytes_, request, nullptr, nullptr),
               "cub::DevicePartition::If");
    cub_storage_ = memory.allocate<char>("compaction", cub_storage_bytes_);
  } else {
    cursors_ = memory.allocate<std::uint32_t>("compaction", 3);
    check_cuda(cudaMemset(cursors_, 0, 3 * sizeof *cursors_), "cudaMemset");
  }
}

void CudaCompactor::enqueue(const CompactionRequest& request, StageClock* clock,
                            cudaStream_t stream) const {
  check_request(request);
  if (request.slot_count > slot_count_max_) {
    throw Error("compaction: " + std::to_string(request.slot_count) +
                " slots; expected at most the " + std::to_string(slot_count_max_) + " announced");
  }
  if (strategy_ == Compaction::cub) {
    std::size_t bytes = cub_storage_bytes_;
    check_cuda(partition(cub_storage_, bytes, request, clock, stream), "cub::DevicePartition::If");
    return;
  }
  const std::uint32_t blocks = request.slot_count == 0 ? 1 : (request.slot_count + tile - 1) / tile;
  if (strategy_ == Compaction::atomic) {
    gather_by_arrival<true><<<blocks, block_threads, 0, stream>>>(request, cursors_, clock);
  } else {
    gather_by_arrival<false><<<blocks, block_threads, 0, stream>>>(request, cursors_, clock);
  }
  check_cuda(cudaGetLastError(), "compact");
}

}  // namespace pt
