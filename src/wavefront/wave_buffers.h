// The memory of a wavefront: the pool of paths, its queues and counters.
#pragma once

#include "wavefront/compaction/compaction.h"
#include "wavefront/stages.h"

namespace pt {

/// How a stage finds its slots.
enum class StageInput {
  queue,       ///< in its queue
  tags,        ///< in the whole pool: those whose tag says that they wait for it
  every_slot,  ///< in the whole pool: all
};

/// Where a stage finds its slots and where they go from there; all in the device's memory.
struct StageQueues {
  StageInput input = StageInput::queue;
  bool appends = true;  ///< finished slots are appended to queues; else their tags are written
  const std::uint32_t* slots = nullptr;  ///< with StageInput::queue, *count of it,
  const std::uint32_t* first = nullptr;  ///< from this index on; null: from 0
  const std::uint32_t* count = nullptr;
  StageId* tags = nullptr;                ///< these two where slots have tags
  StageId* shadow_tags = nullptr;         ///< only with lights
  std::uint32_t* next[queue_count] = {};  ///< where slots are appended; null: not used
  std::uint32_t* waiting = nullptr;       ///< [queue_count] ends of the queues

  /// The slots of StageInput::queue.
  PT_HD const std::uint32_t* begin() const { return slots + (first != nullptr ? *first : 0); }
};

/// The buffers of a wavefront, allocated by the device's renderer.
struct WaveBuffers {
  CompactionInfo compaction;
  PathPool pool;
  WaveCounters* counters = nullptr;
  const std::uint32_t* slot_count = nullptr;  ///< the pool's, in the device's memory
  std::uint32_t* queues[queue_count] = {};    ///< [slot_count] each; null: not needed
  bool reuses_slots = true;     ///< false: the pool holds the whole batch, a free slot stays free
  bool only_triangles = false;  ///< no instances, no spheres
  bool fused = false;           ///< --stages
  bool has_media = false;       ///< the scene has
  bool has_volumes = false;     ///< media with grids of densities
  std::uint32_t wave_collisions = to_the_end;  ///< null ones that a flight has in a wave
  std::uint32_t wave_rays = 1;  ///< where they are fused: rays that a path gets in a wave
  // Pools that share a batch whose paths repeat divide its indices among all of their slots:
  std::uint32_t first_slot = 0;  ///< this pool's, counted through all of them
  std::uint32_t all_slots = 0;
  // The order of surfaces:
  bool orders_surfaces = false;
  std::uint32_t* ordered = nullptr;  ///< [slot_count] the queue of surfaces, in order

  /// Of all queues, at most.
  std::size_t queue_bytes_per_slot() const {
    return queue_count * sizeof(std::uint32_t) + (orders_surfaces ? sizeof *ordered : 0);
  }

  /// Fused stages send paths on while they read the queue of rays: they fill one half of it while
  /// they read the other, alternately. Where the second begins; 0: there is one.
  std::uint32_t half_ring() const { return fused && compaction.appends ? pool.slot_count : 0; }

  /// Calls function(queue, capacity) for each that this render needs.
  template <class Function>
  void for_each_queue(bool has_lights, Function&& function) {
    for (const StageInfo& stage : stage_table) {
      if (!compaction.has_queues || !stage.has_own_queue()) continue;
      if (is_unused(stage.id, has_lights)) continue;
      const bool twice = stage.id == StageId::intersect && half_ring() > 0;
      function(queues[queue_index(stage.id)], std::uint64_t{pool.slot_count} * (twice ? 2 : 1));
    }
    if (orders_surfaces) function(ordered, pool.slot_count);
  }

  std::uint32_t* queue(StageId id) const { return queues[queue_index(id)]; }
  std::uint32_t* waiting(StageId id) const { return &counters->waiting[queue_index(id)]; }

  /// A pass that fills the queues of these stages, which stand side by side in the table.
  template <StageId first, StageId... others>
  CompactionRequest request(const StageId* tags) const {
    constexpr StageId ids[] = {first, others...};
    CompactionRequest result;
    result.tags = tags;
    result.slot_count = result.capacity = pool.slot_count;
    result.counts = waiting(first);
    for (const StageId id : ids) {
      result.wanted[result.queues_wanted] = id;
      result.queues[result.queues_wanted++] = queue(id);
    }
    static_assert(queue_of<ids[std::size(ids) - 1]> == queue_of<first> + int(std::size(ids)) - 1);
    return result;
  }

  StageInput input_of(StageId id) const {
    if (!compaction.has_queues) return StageInput::tags;
    const bool all = id == StageId::generate && !reuses_slots;
    return all ? StageInput::every_slot : StageInput::queue;
  }

  /// For the stage `id`, of which `count` slots wait; `tags` are null where slots have none.
  StageQueues stage_queues(StageId id, const std::uint32_t* count, StageId* tags) const {
    StageQueues result;
    result.input = input_of(id);
    result.appends = compaction.appends;
    result.slots = queue(id);
    if (half_ring() > 0 && queue_index(id) == queue_of<StageId::intersect>) {
      result.first = &counters->first_ray;
    }
    result.count = result.input == StageInput::tags ? slot_count : count;
    result.tags = tags;
    result.shadow_tags = pool.shadow_tag;
    for (int i = 0; i < queue_count; ++i) result.next[i] = queues[i];
    result.waiting = counters->waiting;
    return result;
  }

 private:
  bool is_unused(StageId id, bool has_lights) const {
    switch (id) {
      case StageId::generate:
        return !reuses_slots;
      case StageId::intersect:
        return false;
      case StageId::shadow:
        return fused || !has_lights;
      case StageId::sample_medium:
      case StageId::shade_medium:
        return fused || !has_media;
      default:
        return fused;
    }
  }
};

/// WaveBuffers::wave_collisions.
inline std::uint32_t wave_collisions(const Options& options) {
  return options.wave_collisions == 0 ? to_the_end
                                      : static_cast<std::uint32_t>(options.wave_collisions);
}

}  // namespace pt
