// Compaction: every stage finds the slots that wait for it in a queue. Three ways to fill the
// queues:
//
//   cub     stages write tags; a pass over all tags gathers each queue, in ascending order of slots
//           (CUB's DevicePartition on CUDA, a parallel scan on the CPU)
//   atomic  no pass: a stage that has finished a slot appends it to its next queue, a block of
//           threads reserving its places with one atomic addition; the order is that of arrival
//   none    no queues: stages look at every slot's tag; a pass only counts
//
// Contract of all: a queue holds exactly the slots that wait for its stage, each once, and its
// count is right; nothing else is written.
#pragma once

#include <string>

#include "common/error.h"
#include "common/render/options.h"
#include "wavefront/path_pool.h"

namespace pt {

/// A pass over the tags, for the strategies that make one.
struct CompactionRequest {
  const PathTag* tags = nullptr;  ///< [slot_count]
  std::uint32_t slot_count = 0;
  PathTag wanted[2] = {};           ///< two different tags
  std::uint32_t* queues[2] = {};    ///< [capacity] each; not written with Compaction::none
  std::uint32_t capacity = 0;       ///< of each queue, at least slot_count
  std::uint32_t* counts = nullptr;  ///< [2]: how many slots have wanted[c]
};

inline bool appends_in_stages(Compaction strategy) { return strategy == Compaction::atomic; }

/// Throws Error when a queue could overflow or the request cannot be served.
inline void check_request(const CompactionRequest& request) {
  if (request.capacity < request.slot_count) {
    throw Error("compaction: a queue of " + std::to_string(request.capacity) + " places for " +
                std::to_string(request.slot_count) + " slots; expected at least as many places");
  }
  if (request.wanted[0] == request.wanted[1]) {
    throw Error("compaction: the two wanted tags are the same; expected two different ones");
  }
  if (request.slot_count > 0x7fffffffu) {
    throw Error("compaction: " + std::to_string(request.slot_count) +
                " slots; expected fewer than 2^31");
  }
}

/// Runs one request on the calling thread's oneTBB arena. Not for Compaction::atomic.
void compact_cpu(Compaction strategy, const CompactionRequest& request);

}  // namespace pt
