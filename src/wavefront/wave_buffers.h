// What the waves of a render follow: the plan's policy, and the memory of the pool of paths, its
// queues and counters.
#pragma once

#include "common/plan/execution_plan.h"
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

/// What the plan and the scene decide of the waves, the same on every device.
struct WavePolicy {
  CompactionInfo compaction;
  bool fused = false;                          ///< --stages
  bool orders_surfaces = false;                ///< the queue of surfaces is sorted
  std::uint32_t wave_rays = 1;                 ///< fused: rays of a path in a wave
  std::uint32_t wave_collisions = to_the_end;  ///< null collisions of a flight in a wave
  bool only_triangles = false;                 ///< no instances, no spheres
  bool has_media = false;
  bool has_volumes = false;      ///< media with grids of densities
  PathPool::Fields fields = {};  ///< what a path's slot stores

  WavePolicy() = default;
  WavePolicy(const ExecutionPlan& plan, const SceneTraits& traits, const Scene& scene,
             bool has_grids)
      : compaction(compaction_info(plan.compaction)),
        fused(plan.fused),
        orders_surfaces(plan.orders_surfaces),
        wave_rays(static_cast<std::uint32_t>(plan.wave_rays)),
        only_triangles(scene.has_only_triangles()),
        has_media(traits.has_media),
        has_volumes(has_grids),
        fields{.lights = traits.has_lights() && !plan.fused,
               .instances = traits.geometry == Geometry::mixed,
               .tags = !compaction.appends,
               .receivers = scene.light_selector.has_tree(),
               .layout = plan.layout,
               .hits = !plan.fused,
               .media = traits.has_media,
               .flights = traits.has_media && plan.wave_collisions > 0,
               .extra_records = static_cast<std::uint32_t>(plan.path_bytes / path_bytes_step)} {
    if (plan.wave_collisions > 0)
      wave_collisions = static_cast<std::uint32_t>(plan.wave_collisions);
  }
};

/// The buffers of a wavefront, allocated by the device's renderer.
struct WaveBuffers {
  WavePolicy policy;
  PathPool pool;
  WaveCounters* counters = nullptr;
  const std::uint32_t* slot_count = nullptr;  ///< the pool's, in the device's memory
  std::uint32_t* queues[queue_count] = {};    ///< [slot_count] each; null: not needed
  std::uint32_t* ordered = nullptr;  ///< [slot_count] the queue of surfaces, in order; null: as is
  bool reuses_slots = true;  ///< false: the pool holds the whole batch, a free slot stays free
  // Pools that share a batch whose paths repeat divide its indices among all of their slots:
  std::uint32_t first_slot = 0;  ///< this pool's, counted through all of them
  std::uint32_t all_slots = 0;

  /// Upper bound on the bytes of all queues per slot.
  std::size_t queue_bytes_per_slot() const {
    return queue_count * sizeof(std::uint32_t) + (policy.orders_surfaces ? sizeof *ordered : 0);
  }

  /// Fused stages send paths on while they read the queue of rays: they fill one half of it while
  /// they read the other, alternately. Where the second begins; 0: there is one.
  std::uint32_t half_ring() const {
    return policy.fused && policy.compaction.appends ? pool.slot_count : 0;
  }

  /// Calls function(queue, capacity) for each that this render needs.
  template <class Function>
  void for_each_queue(Function&& function) {
    for (const StageInfo& stage : stage_table) {
      if (!policy.compaction.has_queues || !stage.has_own_queue()) continue;
      if (is_unused(stage.id)) continue;
      const bool twice = stage.id == StageId::intersect && half_ring() > 0;
      function(queues[queue_index(stage.id)], std::uint64_t{pool.slot_count} * (twice ? 2 : 1));
    }
    if (policy.orders_surfaces) function(ordered, pool.slot_count);
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
    if (!policy.compaction.has_queues) return StageInput::tags;
    const bool all = id == StageId::generate && !reuses_slots;
    return all ? StageInput::every_slot : StageInput::queue;
  }

  /// For the stage `id`, of which `count` slots wait; `tags` are null where slots have none.
  StageQueues stage_queues(StageId id, const std::uint32_t* count, StageId* tags) const {
    StageQueues result;
    result.input = input_of(id);
    result.appends = policy.compaction.appends;
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
  bool is_unused(StageId id) const {
    switch (id) {
      case StageId::generate:
        return !reuses_slots;
      case StageId::intersect:
        return false;
      case StageId::shadow:
        return !policy.fields.lights;
      case StageId::sample_medium:
      case StageId::shade_medium:
        return policy.fused || !policy.has_media;
      default:
        return policy.fused;
    }
  }
};

}  // namespace pt
