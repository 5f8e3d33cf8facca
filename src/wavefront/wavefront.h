// The schedule: what one wave does, the same on every device. Read this file first.
#pragma once

#include <memory>

#include "common/render/renderer.h"
#include "common/scene/scene_data.h"
#include "wavefront/compaction.h"
#include "wavefront/stages.h"

namespace pt {

/// Where a stage finds its slots. `slots` null: it looks at all slots and takes those whose tag it is.
struct StageQueue {
  const std::uint32_t* slots;
  const std::uint32_t* count;  ///< in the device's memory
  const PathTag* tags;
};

/// The buffers of a wavefront, allocated by the device's renderer.
struct WaveBuffers {
  PathPool pool;
  WaveCounters* counters = nullptr;
  const std::uint32_t* slot_count = nullptr;  ///< the pool's, in the device's memory
  std::uint32_t* ray_queue = nullptr;      ///< [slot_count] each
  std::uint32_t* free_queue = nullptr;
  std::uint32_t* surface_queue = nullptr;
  std::uint32_t* miss_queue = nullptr;
  std::uint32_t* shadow_queue = nullptr;   ///< in scenes with lights
};

template <class Source>
struct WaveContext {
  WaveBuffers buffers;
  StageContext<Source> stage;
  bool use_queues;  ///< false with Compaction::none

  CompactionRequest request(const PathTag* tags, PathTag a, std::uint32_t* queue_a, PathTag b,
                            std::uint32_t* queue_b, std::uint32_t* counts) const {
    return {tags, buffers.pool.slot_count, {a, b}, {queue_a, queue_b}, buffers.pool.slot_count,
            counts};
  }

  StageQueue queue(const std::uint32_t* slots, const std::uint32_t* count,
                   const PathTag* tags) const {
    return use_queues ? StageQueue{slots, count, tags}
                      : StageQueue{nullptr, buffers.slot_count, tags};
  }
};

/// One wave: every free slot gets a new path, every path in flight one more ray.
/// An Executor runs a compaction, the decision between two waves, or a stage over a queue.
template <class Traits, Branching branching, class Source, class Executor>
void run_wave(Executor& execute, const WaveContext<Source>& wave) {
  const WaveBuffers& b = wave.buffers;
  const PathTag* tags = b.pool.tag;
  WaveCounters* counters = b.counters;

  execute.compact(wave.request(tags, PathTag::intersect, b.ray_queue, PathTag::free, b.free_queue,
                               counters->ready));
  execute.begin_wave();
  execute.run(GeneratePaths<Traits::has_lights, Source>{wave.stage},
              wave.queue(b.free_queue, &counters->generate, tags));
  execute.run(IntersectRays<Traits::accel, branching>{b.pool},
              wave.queue(b.ray_queue, &counters->intersect, tags));

  execute.compact(wave.request(tags, PathTag::surface, b.surface_queue, PathTag::miss, b.miss_queue,
                               counters->shade));
  if constexpr (branching == Branching::divergent) {
    execute.run(ShadeMiss<Traits::has_lights>{b.pool, wave.stage.samples},
                wave.queue(b.miss_queue, &counters->shade[1], tags));
  }
  execute.run(ShadeSurface<Traits::has_lights, branching, Source>{wave.stage},
              wave.queue(b.surface_queue, &counters->shade[0], tags));

  if constexpr (Traits::has_lights) {
    const PathTag* shadow_tags = b.pool.shadow_tag;
    execute.compact(wave.request(shadow_tags, PathTag::surface, b.shadow_queue, PathTag::miss,
                                 b.miss_queue, counters->shadow));
    execute.run(TraceShadowRays<Traits::accel>{b.pool, wave.stage.samples},
                wave.queue(b.shadow_queue, &counters->shadow[0], shadow_tags));
  }
}

std::unique_ptr<Renderer> make_wavefront_cpu(const Options& options, const SceneData& scene);

/// `device`: CUDA device ordinal. Only in a build with CUDA.
std::unique_ptr<Renderer> make_wavefront_cuda(const Options& options, const SceneData& scene,
                                              int device);

}  // namespace pt
