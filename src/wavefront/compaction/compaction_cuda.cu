#include <thrust/iterator/counting_iterator.h>
#include <thrust/iterator/discard_iterator.h>

#include <algorithm>
#include <cub/device/device_partition.cuh>
#include <cub/device/device_select.cuh>

#include "common/cuda/cuda_check.cuh"
#include "common/device/cuda/stage_stamp.cuh"
#include "common/error/error.h"
#include "wavefront/compaction/compaction_cuda.h"
#include "wavefront/compaction/scan_tags.cuh"

namespace pt {
namespace {

constexpr int block_threads = 256;

/// CUB's predicate for each slot. Its call for slot 0 also tells the clock that the
/// compaction has begun: CUB's kernels are not ours to change.
struct HasTag {
  const StageId* tags;
  StageId wanted;
  StageClock* clock;

  __device__ bool operator()(std::uint32_t slot) const {
    const unsigned together = __activemask();
    if (slot == 0 && clock != nullptr) stamp(clock, StageId::compact);
    __syncwarp(together);  // CUB's next barrier wants the warp undivided
    return tags[slot] == wanted;
  }
};

/// Fills one queue or two; without `storage` it only says how much of it that takes.
cudaError_t gather(void* storage, std::size_t& storage_bytes, const CompactionRequest& request,
                   StageClock* clock, cudaStream_t stream) {
  const thrust::counting_iterator<std::uint32_t> slots(0);
  const int count = static_cast<int>(request.slot_count);
  const auto first = HasTag{request.tags, request.wanted[0], clock};
  if (request.queues_wanted == 1) {
    return cub::DeviceSelect::If(storage, storage_bytes, slots, request.queues[0], request.counts,
                                 count, first, stream);
  }
  // Three classes: the first queue, the second, and the slots that wait for neither.
  return cub::DevicePartition::If(storage, storage_bytes, slots, request.queues[0],
                                  request.queues[1], thrust::discard_iterator<>(), request.counts,
                                  count, first, HasTag{request.tags, request.wanted[1], nullptr},
                                  stream);
}

/// Calls launch(rows) with the rows of a warp as a constant: as few as make no more tiles than a
/// GPU has room for at once, since every tile reads the counts of all before it.
template <class Launch>
void with_rows(std::uint32_t slot_count_max, Launch&& launch) {
  constexpr std::uint32_t tiles_wanted = 512;
  const std::uint32_t most = slot_count_max / tiles_wanted;
  if (most <= tile_slots(1)) {
    launch(std::integral_constant<int, 1>());
  } else if (most <= tile_slots(2)) {
    launch(std::integral_constant<int, 2>());
  } else if (most <= tile_slots(4)) {
    launch(std::integral_constant<int, 4>());
  } else {
    launch(std::integral_constant<int, 8>());
  }
}

std::uint32_t count_tiles(std::uint32_t slot_count_max, int rows) {
  return std::max(1u, (slot_count_max + tile_slots(rows) - 1) / tile_slots(rows));
}

/// Every launch has the tiles of `slot_count_max`, whatever the request's slots: see TileState.
void scan(const CompactionRequest& request, std::uint32_t slot_count_max, const TileState& tiles,
          StageClock* clock, cudaStream_t stream) {
  with_rows(slot_count_max, [&](auto rows) {
    const auto kernel = request.queues_wanted > 1 ? scan_tags<2, rows()> : scan_tags<1, rows()>;
    kernel<<<count_tiles(slot_count_max, rows()), scan_threads, 0, stream>>>(request, tiles, clock);
  });
}

/// How many slots have each tag.
__global__ void count_tags(CompactionRequest request, StageClock* clock) {
  if (clock != nullptr) stamp_first_thread(clock, StageId::compact);
  for (std::uint32_t i = blockIdx.x * blockDim.x; i < request.slot_count;
       i += gridDim.x * blockDim.x) {
    const std::uint32_t slot = i + threadIdx.x;
    const bool inside = slot < request.slot_count;
    const StageId tag = inside ? request.tags[slot] : StageId::idle;
    for (int c = 0; c < request.queues_wanted; ++c) {
      const int votes = __syncthreads_count(inside && tag == request.wanted[c]);
      if (threadIdx.x == 0 && votes > 0) atomicAdd(&request.counts[c], votes);
    }
  }
}

}  // namespace

CudaCompactor::CudaCompactor(TagPass pass, std::uint32_t slot_count_max, CudaMemory& memory)
    : pass_(pass), slot_count_max_(slot_count_max) {
  if (pass == TagPass::scan) {
    std::uint32_t tiles = 0;
    with_rows(slot_count_max, [&](auto rows) { tiles = count_tiles(slot_count_max, rows()); });
    tiles_.counts = memory.upload("compaction", std::vector<TagCounts>(tiles));
    tiles_.tickets = memory.upload("compaction", std::vector<std::uint32_t>(1));
  }
  if (pass != TagPass::gather) return;
  CompactionRequest request;
  request.slot_count = slot_count_max;
  for (request.queues_wanted = 1; request.queues_wanted <= 2; ++request.queues_wanted) {
    std::size_t bytes = 0;
    check_cuda(gather(nullptr, bytes, request, nullptr, nullptr), "CUB's storage");
    cub_storage_bytes_ = std::max(cub_storage_bytes_, bytes);
  }
  cub_storage_ = memory.allocate<char>("compaction", cub_storage_bytes_);
}

void CudaCompactor::enqueue(const CompactionRequest& request, StageClock* clock,
                            cudaStream_t stream) const {
  check_request(request);
  if (request.slot_count > slot_count_max_) {
    throw Error("compaction: " + std::to_string(request.slot_count) +
                " slots; expected at most the " + std::to_string(slot_count_max_) + " announced");
  }
  if (pass_ != TagPass::count && request.queues_wanted > 2) {
    throw Error("compaction: " + std::to_string(request.queues_wanted) +
                " queues wanted; expected at most two on CUDA");
  }
  if (pass_ == TagPass::scan) {
    if (reinterpret_cast<std::uintptr_t>(request.tags) % 16 != 0) {
      throw Error("compaction: misaligned tags; expected them at a multiple of 16 bytes");
    }
    scan(request, slot_count_max_, tiles_, clock, stream);
  } else if (pass_ == TagPass::gather) {
    std::size_t bytes = cub_storage_bytes_;
    check_cuda(gather(cub_storage_, bytes, request, clock, stream), "a compaction by CUB");
  } else {
    check_cuda(
        cudaMemsetAsync(request.counts, 0,
                        static_cast<std::size_t>(request.queues_wanted) * sizeof *request.counts,
                        stream),
        "cudaMemsetAsync");
    constexpr std::uint32_t blocks_max = 1024;
    const std::uint32_t blocks = (request.slot_count + block_threads - 1) / block_threads;
    const std::uint32_t grid = std::clamp(blocks, 1u, blocks_max);
    count_tags<<<grid, block_threads, 0, stream>>>(request, clock);
  }
  check_cuda(cudaGetLastError(), "compact");
}

}  // namespace pt
