// The compaction strategies that make a pass over the tags, on CUDA.
#pragma once

#include <cuda_runtime_api.h>

#include "common/cuda/cuda_memory.cuh"
#include "common/device/cuda/stage_clock.h"
#include "wavefront/compaction/compaction.h"
#include "wavefront/compaction/tile_state.h"

namespace pt {

class CudaCompactor {
 public:
  /// `pass`: not TagPass::none. `slot_count_max`: of all requests to come. Memory is taken from
  /// `memory` now, none later.
  CudaCompactor(TagPass pass, std::uint32_t slot_count_max, CudaMemory& memory);

  /// Enqueues the request; its pointers are device memory. Serves two queues at most, but for
  /// TagPass::count. TagPass::scan wants tags at a multiple of 16 bytes. `clock` may be null. Can
  /// be captured into a graph. One pass at a time. Throws Error as check_request does, or when
  /// there are more slots than announced.
  void enqueue(const CompactionRequest& request, StageClock* clock, cudaStream_t stream) const;

 private:
  TagPass pass_;
  std::uint32_t slot_count_max_;
  void* cub_storage_ = nullptr;
  std::size_t cub_storage_bytes_ = 0;
  TileState tiles_;
};

}  // namespace pt
