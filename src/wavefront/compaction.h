// Compaction: gathers the slots that wait for a stage into that stage's queue.
//
// Contract of every strategy, on every device: after compact(request), queue c (c = 0, 1) holds in
// its first counts[c] places exactly the slots whose tag is wanted[c], each once; nothing else is
// written. The order is
//   cub     ascending slots
//   atomic  any order
//   none    no queue is written: counts[c] is right, and a stage looks at every slot's tag.
#pragma once

#include <string>

#include "common/error.h"
#include "common/render/options.h"
#include "wavefront/path_pool.h"

namespace pt {

struct CompactionRequest {
  const PathTag* tags = nullptr;  ///< [slot_count]
  std::uint32_t slot_count = 0;
  PathTag wanted[2] = {};              ///< two different tags
  std::uint32_t* queues[2] = {};       ///< [capacity] each; may be null with Compaction::none
  std::uint32_t capacity = 0;          ///< of each queue, at least slot_count
  std::uint32_t* counts = nullptr;     ///< [2]; need not be zero before
};

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

/// Runs one request on the calling thread's oneTBB arena.
void compact_cpu(Compaction strategy, const CompactionRequest& request);

}  // namespace pt
