// A stage as a parallel loop, and how its slots are sent on.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

#include "common/sampling/draw_block.h"
#include "wavefront/wavefront.h"

namespace pt {

/// Collects what a range of slots sends on, then reserves the places in each queue with one atomic
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
      const std::uint32_t place = atomic_fetch_add(&queues.waiting[q], counts_[q]);
      std::copy_n(slots_[q].begin(), counts_[q], queues.next[q] + place);
      counts_[q] = 0;
    }
  }

 private:
  std::array<std::uint32_t, queue_count> counts_{};
  std::array<std::array<std::uint32_t, range_max>, queue_count> slots_;
};

/// The slot in place `i` of the stage's input; false: it does not wait for the stage.
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

/// A stage that shades: all that it calls, but for what is never inlined, becomes one function, in
/// which a path's values stay in registers. (Across calls they would go through memory: stored by
/// parts, loaded as a whole, for which a processor waits.)
template <class Stage>
[[gnu::flatten]] Next shade_slot(const Stage& stage, const Scene& scene, std::uint32_t slot) {
  return stage(scene, slot, 0);
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

/// Draws the numbers with which `count` paths leave the surfaces that they have met.
template <bool has_lights, class Source, class Slots>
void draw_for_surfaces(const StageContext<Source>& context, const Slots& slots, std::uint32_t count,
                       DrawnBlock& scatter, DrawnBlock& light) {
  const bool together = is_philox(context.source);
  DrawNames names{};
  for (std::uint32_t i = 0; i < count; ++i) {
    const PathState path = context.pool.load_name(slots[i]);
    const PathId id = context.samples.id_of(path.number);
    const std::uint32_t rays = path.rays + 1u;  // with the one that has met the surface
    names.pixel[i] = id.pixel, names.sample[i] = id.sample, names.block[i] = scatter_block(rays);
    if (together) continue;
    auto stream = context.source.open(id);
    scatter.set(i, stream.draw(scatter_block(rays)));
    if (has_lights) light.set(i, stream.draw(light_block(rays)));
  }
  if (!together) return;
  draw_block(context.source.seed, names, count, scatter);
  for (std::uint32_t i = 0; i < count; ++i) names.block[i] |= 1u;  // light_block
  if (has_lights) draw_block(context.source.seed, names, count, light);
}

/// Surfaces whose numbers come from streams without state: drawn for a block of slots, then each is
/// shaded.
template <class Traits, Branching branching, class Source>
requires(!requires(const Source& source) {
  source.states;
}) void run_stage_cpu(const ShadeSurface<Traits, branching, Source>& stage, const Scene& scene,
                      const StageQueues& queues) {
  using Stage = ShadeSurface<Traits, branching, DrawnSource>;
  const auto& [pool, samples, source, counters, ray_queue, limits, chains] = stage.context;
  for_each_range<Stage>(queues, [&](std::uint32_t begin, std::uint32_t end, auto&& send) {
    DrawnBlock scatter, light;
    Stage drawn{{pool, samples, {&scatter, &light}, counters, ray_queue, limits, chains}};
    for_each_block<Stage, DrawNames::size_max>(
        queues, begin, end, [&](const auto& slots, std::uint32_t count) {
          draw_for_surfaces<Traits::has_lights>(stage.context, slots, count, scatter, light);
          for (std::uint32_t i = 0; i < count; ++i) {
            drawn.context.source.place = i;
            send(slots[i], shade_slot(drawn, scene, slots[i]));
          }
        });
  });
}

}  // namespace pt
