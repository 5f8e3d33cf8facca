// Compaction: every stage finds the slots that wait for it in a queue. The ways to fill the queues
// (common/options/compaction_info.h lists them):
//
//   cub     stages write tags; a pass over all tags gathers each queue, in ascending order of slots
//           (CUB's DeviceSelect or, for two, DevicePartition on CUDA; a parallel scan on the CPU)
//   scan    the same; on CUDA by one kernel that compares many tags at once (scan_tags.cuh)
//   atomic  no pass: a stage that has finished a slot appends it to its next queue, a block of
//           threads reserving its entries with one atomic addition; the order is that of arrival
//   none    no queues: stages look at every slot's tag; a pass only counts
//
// Contract of all: a queue holds exactly the slots that wait for its stage, each once, and its
// count is right; nothing else is written.
#pragma once

#include "common/options/compaction_info.h"
#include "wavefront/pool/path_pool.h"

namespace pt {

/// A pass over the tags, for the strategies that make one.
struct CompactionRequest {
  static constexpr int queues_max = 8;

  const StageId* tags = nullptr;  ///< [slot_count]
  std::uint32_t slot_count = 0;
  int queues_wanted = 0;                   ///< 1..queues_max
  StageId wanted[queues_max] = {};         ///< different tags
  std::uint32_t* queues[queues_max] = {};  ///< [capacity] each; not written by TagPass::count
  std::uint32_t capacity = 0;              ///< of each queue, at least slot_count
  std::uint32_t* counts = nullptr;         ///< how many slots have wanted[c]; room for two at least
};

/// Throws Error when a queue could overflow or the request cannot be served.
void check_request(const CompactionRequest& request);

/// Runs one request on the calling thread's oneTBB arena. Not for TagPass::none.
void compact_cpu(TagPass pass, const CompactionRequest& request);

}  // namespace pt
