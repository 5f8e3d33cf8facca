// The schedule: what one wave does, the same on every device. Read this file first.
#pragma once

#include <memory>

#include "common/render/renderer.h"
#include "common/scene/scene_data.h"
#include "wavefront/compaction.h"
#include "wavefront/stages.h"

namespace pt {

/// Where a stage finds its slots, the first *count of a queue, and where they go from there; all in
/// the device's memory.
struct StageQueues {
  const std::uint32_t* slots = nullptr;  ///< null: slots in their own order; of those that have
                                         ///< tags, the ones whose tag is the stage's
  const std::uint32_t* count = nullptr;
  PathTag* tags = nullptr;  ///< null: slots are appended to the queues instead
  PathTag* shadow_tags = nullptr;
  std::uint32_t* next[queue_count] = {};  ///< null: nobody waits there
  std::uint32_t* waiting = nullptr;       ///< [queue_count] ends of the queues
};

/// The buffers of a wavefront, allocated by the device's renderer.
struct WaveBuffers {
  PathPool pool;
  WaveCounters* counters = nullptr;
  const std::uint32_t* slot_count = nullptr;  ///< the pool's, in the device's memory
  std::uint32_t* queues[queue_count] = {};    ///< [slot_count] each; null without queues
  bool reuses_slots = true;  ///< false: the pool holds the whole batch, a free slot stays free

  std::uint32_t* queue(QueueId id) const { return queues[static_cast<int>(id)]; }
  std::uint32_t* waiting(QueueId id) const { return &counters->waiting[static_cast<int>(id)]; }

  /// A pass that fills the queue `id` with the slots tagged `a` and the one after it with those
  /// tagged `b`.
  CompactionRequest request(const PathTag* tags, QueueId id, PathTag a, PathTag b) const {
    const int i = static_cast<int>(id);
    std::uint32_t* second =
        i + 1 < queue_count ? queues[i + 1] : queues[0];  // no slot is tagged so
    return {tags, pool.slot_count, {a, b}, {queues[i], second}, pool.slot_count, waiting(id)};
  }

  StageQueues stage_queues(QueueId id, const std::uint32_t* count, PathTag* tags) const {
    StageQueues result;
    const bool looks_at_tags = queue(id) == nullptr && tags != nullptr;
    result.slots = queue(id);
    result.count = looks_at_tags ? slot_count : count;
    result.tags = tags;
    result.shadow_tags = pool.shadow_tag;
    for (int i = 0; i < queue_count; ++i) result.next[i] = queues[i];
    if (!reuses_slots) result.next[static_cast<int>(QueueId::free)] = nullptr;
    result.waiting = counters->waiting;
    return result;
  }
};

/// One wave: free slots get new paths, and every path in flight one more ray. An Executor fills the
/// queues by a pass (a no-op where stages append), decides between two waves, and runs a stage.
/// Without `starts_paths` it does not look for free slots.
template <class Traits, Branching branching, class Source, class Executor>
void run_wave(Executor& execute, const WaveBuffers& b, const StageContext<Source>& context,
              bool starts_paths = true) {
  using enum QueueId;
  PathTag* tags = b.pool.tag;
  const WaveCounters* counters = b.counters;

  execute.compact(b.request(tags, free, PathTag::free, PathTag::intersect));
  execute.begin_wave();
  if (starts_paths) {
    execute.run(GeneratePaths<Source>{context, Traits::has_lights},
                b.stage_queues(free, &counters->generate, tags));
  }
  execute.run(IntersectRays<RayTraits<Traits>>{b.pool, branching == Branching::divergent},
              b.stage_queues(intersect, &counters->intersect, tags));

  execute.compact(b.request(tags, miss, PathTag::miss, PathTag::surface));
  if constexpr (branching == Branching::divergent) {
    constexpr Lighting sky = Traits::lighting == Lighting::full ? Lighting::full : Lighting::sky;
    execute.run(ShadeMiss<sky>{b.pool, context.samples, Traits::has_lights},
                b.stage_queues(miss, b.waiting(miss), tags));
  }
  execute.run(ShadeSurface<ShadingTraits<Traits>, branching, Source>{context},
              b.stage_queues(surface, b.waiting(surface), tags));

  if constexpr (Traits::has_lights) {
    PathTag* shadow_tags = b.pool.shadow_tag;
    execute.compact(b.request(shadow_tags, shadow, PathTag::surface, PathTag::miss));
    execute.run(TraceShadowRays<RayTraits<Traits>>{b.pool, context.samples},
                b.stage_queues(shadow, b.waiting(shadow), shadow_tags));
  }
}

/// After the last wave: the paths that begin_wave left over are followed to their ends.
template <class Traits, class Source, class Executor>
void run_finish(Executor& execute, const WaveBuffers& b, const StageContext<Source>& context) {
  execute.run(FinishPaths<Traits, Source>{context},
              b.stage_queues(QueueId::intersect, &b.counters->finish, b.pool.tag));
}

std::unique_ptr<Renderer> make_wavefront_cpu(const Options& options, const SceneData& scene);

/// `device`: CUDA device ordinal. Only in a build with CUDA.
std::unique_ptr<Renderer> make_wavefront_cuda(const Options& options, const SceneData& scene,
                                              int device);

}  // namespace pt
