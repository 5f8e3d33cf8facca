// A stage as a parallel loop, and how its slots are sent on.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

#include "wavefront/wave_buffers.h"

namespace pt {

/// Collects what a range of slots sends on, then reserves the entries of each queue with one atomic
/// addition.
class RangeAppender {
 public:
  static constexpr std::uint32_t range_max = 512;

  void append(StageId to, std::uint32_t slot) {
    const int q = queue_index(to);
    slots_[q][counts_[q]++] = slot;
  }

  void flush(const StageQueues& queues) {
    for (int q = 0; q < queue_count; ++q) {
      if (counts_[q] == 0) continue;
      const std::uint32_t first = atomic_fetch_add(&queues.waiting[q], counts_[q]);
      std::copy_n(slots_[q].begin(), counts_[q], queues.next[q] + first);
      counts_[q] = 0;
    }
  }

 private:
  std::array<std::uint32_t, queue_count> counts_{};
  std::array<std::array<std::uint32_t, range_max>, queue_count> slots_;
};

/// The slot at index `i` of the stage's input; false: it does not wait for the stage.
template <class Stage>
bool finds_slot(const StageQueues& queues, std::uint32_t i, std::uint32_t& slot) {
  slot = queues.input == StageInput::queue ? queues.begin()[i] : i;
  return queues.input != StageInput::tags || queues.tags[slot] == stage_info(Stage::id).queue;
}

/// Calls run_range(begin, end, send) for ranges of the stage's input, on the calling thread's
/// oneTBB arena; send(slot, next) sends a finished slot on.
template <class Stage, class RunRange>
void for_each_range(const StageQueues& queues, RunRange&& run_range) {
  // simple_partitioner: no range is longer than its grain.
  const tbb::blocked_range<std::uint32_t> all(0, *queues.count, RangeAppender::range_max);
  const auto run = [&](const tbb::blocked_range<std::uint32_t>& range) {
    RangeAppender appender;
    run_range(range.begin(), range.end(), [&](std::uint32_t slot, const Next& next) {
      if (!queues.appends) {
        queues.tags[slot] = next.to;
        if (Stage::outcomes.casts_shadow_rays) {
          queues.shadow_tags[slot] = next.shadow ? StageId::shadow : free_slot;
        }
      } else {
        if (Stage::outcomes.sends && queues.next[queue_index(next.to)] != nullptr) {
          appender.append(next.to, slot);
        }
        if (next.shadow) appender.append(StageId::shadow, slot);
      }
    });
    if (queues.appends) appender.flush(queues);
  };
  tbb::parallel_for(all, run, tbb::simple_partitioner());
}

/// Runs `stage` over its queue and sends every slot on.
template <class Stage>
void run_stage_cpu(const Stage& stage, const Scene& scene, const StageQueues& queues) {
  for_each_range<Stage>(queues, [&](std::uint32_t begin, std::uint32_t end, auto&& send) {
    for (std::uint32_t i = begin; i < end; ++i) {
      std::uint32_t slot;
      if (finds_slot<Stage>(queues, i, slot)) send(slot, stage(scene, slot, i));
    }
  });
}

/// Calls function(slots, count) with those of a range that wait for the stage, some at a time.
template <class Stage, std::size_t size_max, class Function>
void for_each_block(const StageQueues& queues, std::uint32_t begin, std::uint32_t end,
                    Function&& function) {
  std::array<std::uint32_t, size_max> slots;
  while (begin < end) {
    std::uint32_t count = 0;
    for (; begin < end && count < size_max; ++begin) {
      std::uint32_t slot;
      if (finds_slot<Stage>(queues, begin, slot)) slots[count++] = slot;
    }
    if (count > 0) function(slots, count);
  }
}

}  // namespace pt
