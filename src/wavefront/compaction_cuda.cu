#include <thrust/iterator/counting_iterator.h>
#include <thrust/iterator/discard_iterator.h>

#include <algorithm>
#include <cub/device/device_partition.cuh>
#include <cub/device/device_select.cuh>

#include "common/device/cuda_check.cuh"
#include "common/device/stage_stamp.cuh"
#include "common/error.h"
#include "wavefront/compaction_cuda.h"

namespace pt {
namespace {

constexpr int block_threads = 256;

/// CUB's question for each slot. Being asked about slot 0 is also how the clock learns that the
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
  if (pass_ == TagPass::gather) {
    if (request.queues_wanted > 2) {
      throw Error("compaction: " + std::to_string(request.queues_wanted) +
                  " queues wanted; expected at most two on CUDA");
    }
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
