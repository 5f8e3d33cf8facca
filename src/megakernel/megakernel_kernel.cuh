// The megakernel itself, and the three ways of dividing the paths over its threads.
#pragma once

#include "common/device/cuda/bind_scene.cuh"
#include "common/device/cuda/stage_stamp.cuh"
#include "megakernel/trace_path.h"

namespace pt {

/// What a thread needs to find its paths.
struct WorkDivision {
  Work work;
  std::uint32_t width, height;
  std::uint32_t* next_path;  ///< persistent: paths handed out so far
};

/// Paths that a persistent warp fetches at once: few atomic operations, and an even end.
inline constexpr std::uint32_t fetch_size = 128;

/// Gives a thread its paths. All threads of a warp call next() together.
class ThreadWork {
 public:
  __device__ ThreadWork(const WorkDivision& division, const SampleBuffer& batch)
      : division_(division), batch_(batch), warp_(__activemask()) {
    if (division.work == Work::persistent) return;
    // pixel: a thread for every pixel, its samples one after the other.
    // sample: the third dimension of the grid is the sample.
    const std::uint32_t x = blockIdx.x * blockDim.x + threadIdx.x;
    const std::uint32_t y = blockIdx.y * blockDim.y + threadIdx.y;
    if (x >= division.width || y >= division.height) return;
    const bool one = division.work == Work::sample;
    next_ = batch.index_of(x, y, one ? blockIdx.z : 0);
    end_ = one ? next_ + 1 : batch.path_count;
  }

  __device__ bool any(bool value) const { return __any_sync(warp_, value); }

  __device__ bool next(std::uint32_t& path_index, bool wanted) {
    if (division_.work == Work::persistent) return fetch(path_index, wanted);
    if (!wanted) return true;
    if (next_ >= end_) return false;
    path_index = next_;
    next_ += batch_.pixel_count.divisor();
    return true;
  }

 private:
  /// The warp owns the paths [next_, end_), the same in all of its threads; when they run out in
  /// the middle of a request, one of them fetches more for all.
  __device__ bool fetch(std::uint32_t& path_index, bool wanted) {
    const std::uint32_t asking = __ballot_sync(warp_, wanted);
    const std::uint32_t lane = (threadIdx.y * blockDim.x + threadIdx.x) & 31;
    const std::uint32_t rank = __popc(asking & ((1u << lane) - 1));
    const std::uint32_t count = __popc(asking);
    const std::uint32_t left = end_ - next_;
    std::uint32_t fetched = next_ + rank;
    next_ += count;
    if (count > left) {
      const int leader = __ffs(warp_) - 1;
      std::uint32_t first = 0;
      if (lane == leader) first = atomicAdd(division_.next_path, fetch_size);
      first = __shfl_sync(warp_, first, leader);
      if (rank >= left) fetched = first + (rank - left);
      next_ = first + (count - left);
      end_ = first + fetch_size;
    }
    if (!wanted) return true;
    if (fetched >= batch_.path_count) return false;
    path_index = fetched;
    return true;
  }

  const WorkDivision& division_;
  const SampleBuffer& batch_;
  std::uint32_t warp_;  ///< the threads of this warp
  std::uint32_t next_ = 0, end_ = 0;
};

/// Most threads of a block: 64 registers for each, and one more for each word that it carries.
template <class Source>
inline constexpr int loop_block_max = 65536 / (64 + 4 * extra_records_of<Source>()) / 128 * 128;

template <class Traits, Branching branching, SceneMemory memory, class Source>
__global__ void __launch_bounds__(loop_block_max<Source>)
    megakernel(const __grid_constant__ SceneStorage<memory> storage,
               const __grid_constant__ SampleBuffer batch,
               const __grid_constant__ WorkDivision division, Source source,
               const __grid_constant__ PathSettings settings, StageClock* clock) {
  stamp_first_thread(clock, StageId::megakernel);
  const Scene& scene = storage.bind();
  ThreadWork work(division, batch);
  trace_paths<Traits, branching>(scene, source, batch, settings, work);
}

}  // namespace pt
