// The waves: what one of them does, the same on every device.
#pragma once

#include <memory>

#include "common/render/renderer.h"
#include "common/scene/data/scene_data.h"
#include "wavefront/compaction/compaction.h"
#include "wavefront/stages.h"
#include "wavefront/surface_order.h"

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
  bool shades_by_kind = false;            ///< --shade material: only where they are ordered
  std::uint32_t kinds = 0;                ///< a bit for each MaterialKind of the scene
  std::uint8_t* kind_of_entry = nullptr;  ///< [slot_count] likewise
  std::uint32_t* ordered = nullptr;       ///< [slot_count] the queue of surfaces, in order

  /// Of all queues, at most.
  std::size_t queue_bytes_per_slot() const {
    return queue_count * sizeof(std::uint32_t) + (orders_surfaces ? sizeof *ordered : 0) +
           (shades_by_kind ? sizeof *kind_of_entry : 0);
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
    if (shades_by_kind) function(kind_of_entry, pool.slot_count);
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

// What follows is written for an Executor, the device's way to do it:
//   compact(request)         a pass over the tags, where the strategy makes one
//   order_surfaces(order)    see surface_order.h
//   begin_wave()             the decision between two waves
//   run(stage, queues)       a stage over its slots, a thread for each
//   kinds_have_kernels<Traits, Bsdf>  whether it has a kernel for this kind in such scenes; else
//   the
//                            one for all shades its range
//   streams_shading          whether it is short of registers (PoolSink)
//   traces_queues<Traits>    whether persistent warps can trace queues of rays in scenes of such
//                            kinds, and
//   traces_queues_here()     in this very one;
//   trace_queue(queues, samples)          does so: the next hit of each path is stored
//   trace_shadow_queue(queues, samples)   likewise: light that arrives is added
//   flies_queues             whether persistent warps can take flights to their ends:
//   fly_queue(queues, samples)            does so; collisions are stored as hits

/// The closest hit of every ray. Persistent warps trace the whole queue and store the hits, and a
/// short stage, route_hits, sends the paths on; a thread per ray does both at once.
template <class Traits, class Executor>
void trace_rays(Executor& execute, const WaveBuffers& b, const SampleBuffer& samples,
                bool parts_misses) {
  const StageQueues rays = b.stage_queues(StageId::intersect, &b.counters->intersect, b.pool.tag);
  if constexpr (Executor::template traces_queues<Traits>) {
    if (rays.appends && execute.traces_queues_here()) {
      execute.trace_queue(rays, samples);
      execute.run(RouteHits<Traits::has_media>{b.pool}, rays);
      return;
    }
  }
  execute.run(IntersectRays<RayTraits<Traits>>{{b.pool, parts_misses}, samples}, rays);
}

/// The shadow rays, likewise.
template <class Traits, class Executor>
void trace_shadow_rays(Executor& execute, const WaveBuffers& b, const SampleBuffer& samples) {
  const StageQueues rays =
      b.stage_queues(StageId::shadow, b.waiting(StageId::shadow), b.pool.shadow_tag);
  if constexpr (Executor::template traces_queues<Traits>) {
    if (rays.appends && execute.traces_queues_here()) {
      if constexpr (Traits::has_media) execute.run(DimShadowRays{b.pool, samples}, rays);
      return execute.trace_shadow_queue(rays, samples);
    }
  }
  execute.run(TraceShadowRays<RayTraits<Traits>>{{b.pool, samples}}, rays);
}

/// Surfaces by one kernel, which streams its results where that pays.
template <class Shading, Branching branching, class Source, class Executor>
void shade_surfaces_by(Executor& execute, const StageContext<Source>& context,
                       const StageQueues& surfaces) {
  constexpr bool streams = Executor::streams_shading && Shading::lighting == Lighting::full;
  execute.run(ShadeSurface<Shading, branching, Source, streams>{context}, surfaces);
}

/// Surfaces by kernels for one kind of BSDF each, and by one for all where only shading can
/// tell the kind. `surfaces`: their ordered queue.
template <class Shading, class Source, class Executor>
void shade_each_kind(Executor& execute, const WaveBuffers& b, const StageContext<Source>& context,
                     const StageQueues& surfaces) {
  const auto shade = [&]<class Kind>(std::type_identity<Kind>, MaterialKind kind) {
    const int k = static_cast<int>(kind);
    if ((b.kinds >> k & 1) == 0) return;
    StageQueues range = surfaces;
    range.first = &b.counters->kinds.first[k], range.count = &b.counters->kinds.count[k];
    shade_surfaces_by<Kind, Branching::divergent>(execute, context, range);
  };
  for_each_type(Bsdfs{}, [&]<class Bsdf>(std::type_identity<Bsdf>) {
    using Kind = std::conditional_t<(Executor::template kinds_have_kernels<Shading, Bsdf>),
                                    OneKind<Shading, Bsdf>, Shading>;
    shade(std::type_identity<Kind>{}, kind_of<Bsdf>);
  });
  shade(std::type_identity<Shading>{}, several_kinds);
}

template <class Shading, Branching branching, class Source, class Executor>
void shade_surfaces(Executor& execute, const WaveBuffers& b, const StageContext<Source>& context) {
  constexpr StageId id = StageId::shade_surface;
  StageQueues surfaces = b.stage_queues(id, b.waiting(id), b.pool.tag);
  if (b.orders_surfaces) {
    KindRanges* const ranges = b.shades_by_kind ? &b.counters->kinds : nullptr;
    execute.order_surfaces(
        SurfaceOrder{b.pool, surfaces.slots, surfaces.count, b.ordered, ranges, b.kind_of_entry});
    surfaces.slots = b.ordered;
  }
  if constexpr (Shading::lighting == Lighting::full) {
    if (b.shades_by_kind) return shade_each_kind<Shading>(execute, b, context, surfaces);
  }
  shade_surfaces_by<Shading, branching>(execute, context, surfaces);
}

/// Where paths repeat: paths that have ended are followed by the next ones of their indices, which
/// wait for rays as continuing ones do.
template <class Source, class Executor>
void repeat_paths(Executor& execute, const WaveBuffers& b, const StageContext<Source>& context) {
  constexpr StageId id = StageId::mutate;
  execute.compact(b.request<free_slot>(b.pool.tag));
  StageQueues free = b.stage_queues(id, b.waiting(id), b.pool.tag);
  free.next[queue_index(free_slot)] = nullptr;
  execute.run(RepeatPaths<Source>{context, b.first_slot, b.all_slots}, free);
}

/// Fused stages: every path in flight gets `wave_rays` more rays. With `starts_paths` all of them
/// are new.
template <class Traits, class Source, class Executor>
void bounce_paths(Executor& execute, const WaveBuffers& b, const StageContext<Source>& context,
                  bool starts_paths) {
  StageQueues paths = b.stage_queues(StageId::bounce, &b.counters->intersect, b.pool.tag);
  if (starts_paths) paths.input = StageInput::every_slot;
  execute.run(FollowPaths<Traits, Source>{context, StageId::bounce, b.wave_rays, starts_paths},
              paths);
}

/// The free flights of paths in media, by persistent warps or by a thread each, as with rays.
template <class Executor>
void fly(Executor& execute, const WaveBuffers& b, const SampleBuffer& samples) {
  constexpr StageId id = StageId::sample_medium;
  const StageQueues flights = b.stage_queues(id, b.waiting(id), b.pool.tag);
  if constexpr (Executor::flies_queues) {
    if (flights.appends && b.has_volumes && b.wave_collisions == to_the_end) {
      execute.fly_queue(flights, samples);
      execute.run(RouteFlights{b.pool}, flights);
      return;
    }
  }
  execute.run(SampleMedium{b.pool, samples, b.wave_collisions}, flights);
}

/// Paths in media fly there first. All paths then wait for what they have met.
template <class Executor>
void sample_media(Executor& execute, const WaveBuffers& b, const SampleBuffer& samples) {
  execute.compact(b.request<StageId::sample_medium>(b.pool.tag));
  fly(execute, b, samples);
  // A pass on CUDA fills at most two queues, and may use the count behind them.
  execute.compact(b.request<StageId::shade_miss, StageId::shade_surface>(b.pool.tag));
  execute.compact(b.request<StageId::shade_medium>(b.pool.tag));
}

/// One wave: free slots get new paths, and every path in flight one more ray. Without
/// `starts_paths` it does not look for free slots.
template <class Traits, Branching branching, class Source, class Executor>
void run_wave(Executor& execute, const WaveBuffers& b, const StageContext<Source>& context,
              bool starts_paths = true) {
  using enum StageId;
  constexpr bool parts_misses = branching == Branching::divergent;
  StageId* tags = b.pool.tag;

  if constexpr (std::is_same_v<Source, SamplerSource>) {
    if (context.supply.repeats()) repeat_paths(execute, b, context);
  }
  execute.compact(b.request<generate, intersect>(tags));
  execute.begin_wave();
  const bool all_new = b.fused && starts_paths && !b.reuses_slots;
  if (starts_paths && !all_new && !context.supply.repeats()) {
    execute.run(GeneratePaths<Source>{context, Traits::has_lights},
                b.stage_queues(generate, &b.counters->generate, tags));
  }
  if (b.fused) return bounce_paths<Traits>(execute, b, context, all_new);
  trace_rays<Traits>(execute, b, context.samples, parts_misses);

  if constexpr (Traits::has_media) {
    sample_media(execute, b, context.samples);
  } else {
    execute.compact(b.request<shade_miss, shade_surface>(tags));
  }
  if constexpr (parts_misses) {
    constexpr Lighting sky = Traits::lighting == Lighting::full ? Lighting::full : Lighting::sky;
    execute.run(ShadeMiss<typename Traits::Integrator, sky>{b.pool, context.samples, context.limits,
                                                            Traits::has_lights},
                b.stage_queues(shade_miss, b.waiting(shade_miss), tags));
  }
  using Shading = ShadingTraits<Traits>;
  // Masks and media make a scene `mixed` for its rays, but not for its surfaces.
  constexpr bool may_be_plain = Traits::has_masks;
  if (may_be_plain && b.only_triangles) {
    using Plain = std::conditional_t<may_be_plain, TrianglesAlone<Shading>, Shading>;
    shade_surfaces<Plain, branching>(execute, b, context);
  } else {
    shade_surfaces<Shading, branching>(execute, b, context);
  }

  if constexpr (Traits::has_media) {
    execute.run(ShadeMedium<Shading, Source>{context},
                b.stage_queues(shade_medium, b.waiting(shade_medium), tags));
  }

  if constexpr (Traits::has_lights) {
    execute.compact(b.request<shadow>(b.pool.shadow_tag));
    trace_shadow_rays<Traits>(execute, b, context.samples);
  }
}

/// After the last wave: the paths that begin_wave left over are followed to their ends.
template <class Traits, class Source, class Executor>
void run_finish(Executor& execute, const WaveBuffers& b, const StageContext<Source>& context) {
  StageQueues paths = b.stage_queues(StageId::finish, &b.counters->finish, b.pool.tag);
  for (std::uint32_t*& next : paths.next) next = nullptr;  // no stage follows
  constexpr std::uint32_t all_rays = ~0u;
  execute.run(FollowPaths<Traits, Source>{context, StageId::finish, all_rays}, paths);
}

std::unique_ptr<Renderer> make_wavefront_cpu(const Options& options, const SceneData& scene);

/// `device`: CUDA device ordinal. Only in a build with CUDA.
std::unique_ptr<Renderer> make_wavefront_cuda(const Options& options, const SceneData& scene,
                                              int device);

}  // namespace pt
