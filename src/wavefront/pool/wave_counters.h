// The counts of a wave, in the device's memory: the host is not needed between two waves.
#pragma once

#include "common/options/stage_info.h"

namespace pt {

struct WaveCounters {
  std::uint32_t waiting[queue_count + 1];  ///< slots in each queue; a pass may use the one behind
  std::uint32_t live;                      ///< paths in flight when the wave begins
  std::uint32_t first_ray;                 ///< index of the first of them in the queue of rays
  std::uint32_t next_first_ray;            ///< likewise of those that the wave sends on
  std::uint32_t generate;                  ///< paths that it starts, in the first free slots
  std::uint32_t intersect;                 ///< rays that it traces: live + generate
  std::uint32_t finish;                    ///< paths left over when the waves end
  std::uint32_t first_path;                ///< index of the first path that it starts
  std::uint32_t next_path;                 ///< paths started so far
  std::uint32_t ticket;                    ///< paths handed out where no queue ranks the free slots
  std::uint32_t traced;                    ///< rays handed out to persistent warps
  std::uint32_t shadow_traced;             ///< shadow rays, likewise
  std::uint32_t flown;                     ///< flights, likewise
  std::uint32_t waves;
};

/// Decides how many free slots get a new path and empties the queues behind the rays. Returns false
/// when the waves end: no path is left to start, and no more than `finish_paths` are alive. Without
/// regeneration the pool is filled again only when all of its paths have ended. Where
/// paths repeat, a stage before has started them: `path_count` is 0. `half`: where the second half
/// of the queue of rays begins, if the wave fills one while it reads the other; else 0.
PT_HD bool begin_wave(WaveCounters& c, std::uint32_t path_count, bool regenerate,
                      std::uint32_t finish_paths, std::uint32_t half = 0) {
  constexpr int free_queue = queue_of<StageId::generate>, ray_queue = queue_of<StageId::intersect>;
  std::uint32_t& free = c.waiting[free_queue];
  std::uint32_t& rays = c.waiting[ray_queue];
  const std::uint32_t remaining = path_count - c.next_path;
  for (int queue = 0; queue < queue_count; ++queue) {
    if (queue != free_queue && queue != ray_queue) c.waiting[queue] = 0;
  }
  c.first_ray = c.next_first_ray;
  c.live = rays - c.first_ray;
  c.generate = 0;
  c.intersect = 0;
  c.ticket = 0;
  c.traced = c.shadow_traced = c.flown = 0;
  if (remaining == 0) free = 0;  // free slots stay free
  if (remaining == 0 && c.live <= finish_paths) {
    c.finish = c.live;
    return false;
  }
  if (regenerate || c.live == 0) c.generate = free < remaining ? free : remaining;
  c.intersect = c.live + c.generate;
  c.first_path = c.next_path;
  c.next_path += c.generate;
  free -= c.generate;
  rays = c.next_first_ray = c.first_ray == 0 ? half : 0;
  ++c.waves;
  return true;
}

}  // namespace pt
