// The steps of a wave: which stage runs over which slots. A step decides at compile time what a
// scene does not need, so that loop.h reads without conditions. An Executor is the device's way to
// do it:
//   compact(request)         a pass over the tags, where the strategy makes one
//   order_surfaces(order)    see surface_order.h
//   begin_wave()             the decision between two waves
//   run(stage, queues)       a stage over its slots, a thread for each
//   streams_shading          whether it is short of registers (PoolSink)
//   traces_queues<Traits>    whether persistent warps can trace queues of rays in scenes of such
//                            kinds, and
//   traces_queues_here()     in this very one;
//   trace_queue(queues, samples)          does so: the next hit of each path is stored
//   trace_shadow_queue(queues, samples)   likewise: light that arrives is added
//   flies_queues             whether persistent warps can take flights to their ends:
//   fly_queue(queues, samples)            does so; collisions are stored as hits
#pragma once

#include "common/options/options.h"
#include "wavefront/surface_order.h"
#include "wavefront/wave_buffers.h"

namespace pt {

/// Paths of Markov chains follow one another in the same slots: those that have ended are followed
/// by the next ones of their indices, which wait for rays as continuing ones do.
template <class Source, class Executor>
void repeat_paths(Executor& execute, const WaveBuffers& b, const StageContext<Source>& context) {
  if constexpr (std::is_same_v<Source, SamplerSource>) {
    if (!context.supply.has_chains()) return;
    constexpr StageId id = StageId::mutate;
    execute.compact(b.request<free_slot>(b.pool.tag));
    StageQueues free = b.stage_queues(id, b.waiting(id), b.pool.tag);
    free.next[queue_index(free_slot)] = nullptr;
    execute.run(RepeatPaths<Source>{context, b.first_slot, b.all_slots}, free);
  }
}

/// New paths in free slots.
template <class Traits, class Source, class Executor>
void generate_paths(Executor& execute, const WaveBuffers& b, const StageContext<Source>& context) {
  if (context.supply.has_chains()) return;
  execute.run(GeneratePaths<Source, Traits::has_motion>{context, Traits::has_lights},
              b.stage_queues(StageId::generate, &b.counters->generate, b.pool.tag));
}

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

/// The free flights of paths in media, by persistent warps or by a thread each, as with rays.
template <class Traits, class Executor>
void fly(Executor& execute, const WaveBuffers& b, const SampleBuffer& samples) {
  constexpr StageId id = StageId::sample_medium;
  const StageQueues flights = b.stage_queues(id, b.waiting(id), b.pool.tag);
  if constexpr (Executor::flies_queues) {
    if (flights.appends && b.policy.has_volumes && b.policy.wave_collisions == to_the_end) {
      execute.fly_queue(flights, samples);
      execute.run(RouteFlights{b.pool}, flights);
      return;
    }
  }
  execute.run(SampleMedium<Traits::has_sparse>{b.pool, samples, b.policy.wave_collisions}, flights);
}

/// Paths in media take their free flights first. All paths then wait for their next event: a miss,
/// a surface or a collision.
template <class Traits, class Executor>
void sample_media(Executor& execute, const WaveBuffers& b, const SampleBuffer& samples) {
  using enum StageId;
  if constexpr (Traits::has_media) {
    execute.compact(b.request<sample_medium>(b.pool.tag));
    fly<Traits>(execute, b, samples);
  }
  // A pass on CUDA fills at most two queues, and may use the count behind them.
  execute.compact(b.request<shade_miss, shade_surface>(b.pool.tag));
  if constexpr (Traits::has_media) execute.compact(b.request<shade_medium>(b.pool.tag));
}

/// The misses; with branch-free shading they are among the surfaces.
template <class Traits, Branching branching, class Source, class Executor>
void shade_misses(Executor& execute, const WaveBuffers& b, const StageContext<Source>& context) {
  if constexpr (branching == Branching::divergent) {
    constexpr StageId id = StageId::shade_miss;
    constexpr Lighting sky = Traits::lighting == Lighting::full ? Lighting::full : Lighting::sky;
    execute.run(ShadeMiss<sky, carries_extra<Source>>{b.pool, context.samples, context.settings,
                                                      Traits::has_lights},
                b.stage_queues(id, b.waiting(id), b.pool.tag));
  }
}

/// All surfaces by one kernel, which streams its results where that pays.
template <class Shading, Branching branching, class Source, class Executor>
void shade_all_surfaces(Executor& execute, const WaveBuffers& b,
                        const StageContext<Source>& context) {
  constexpr StageId id = StageId::shade_surface;
  StageQueues surfaces = b.stage_queues(id, b.waiting(id), b.pool.tag);
  if (b.policy.orders_surfaces) {
    execute.order_surfaces(SurfaceOrder{b.pool, surfaces.slots, surfaces.count, b.ordered});
    surfaces.slots = b.ordered;
  }
  constexpr bool streams = Executor::streams_shading && Shading::lighting == Lighting::full;
  execute.run(ShadeSurface<Shading, branching, Source, streams>{context}, surfaces);
}

/// On CUDA masks and media make a scene `mixed` for its rays, but not for its surfaces.
template <class Traits, Branching branching, class Source, class Executor>
void shade_surfaces(Executor& execute, const WaveBuffers& b, const StageContext<Source>& context) {
  using Shading = ShadingTraits<Traits>;
  if constexpr (Traits::has_masks && !Traits::has_motion && Traits::accel != Accel::any) {
    if (b.policy.only_triangles)
      return shade_all_surfaces<TrianglesAlone<Shading>, branching>(execute, b, context);
  }
  shade_all_surfaces<Shading, branching>(execute, b, context);
}

/// The collisions in media.
template <class Traits, class Source, class Executor>
void shade_media(Executor& execute, const WaveBuffers& b, const StageContext<Source>& context) {
  if constexpr (Traits::has_media) {
    constexpr StageId id = StageId::shade_medium;
    execute.run(ShadeMedium<CollisionTraits<Traits>, Source>{context},
                b.stage_queues(id, b.waiting(id), b.pool.tag));
  }
}

/// The shadow rays, as trace_rays.
template <class Traits, class Executor>
void trace_shadow_rays(Executor& execute, const WaveBuffers& b, const SampleBuffer& samples) {
  if constexpr (Traits::has_lights) {
    execute.compact(b.request<StageId::shadow>(b.pool.shadow_tag));
    const StageQueues rays =
        b.stage_queues(StageId::shadow, b.waiting(StageId::shadow), b.pool.shadow_tag);
    if constexpr (Executor::template traces_queues<Traits>) {
      if (rays.appends && execute.traces_queues_here()) {
        if constexpr (Traits::has_media) execute.run(AttenuateShadowRays{b.pool, samples}, rays);
        return execute.trace_shadow_queue(rays, samples);
      }
    }
    execute.run(TraceShadowRays<ShadowRayTraits<Traits>>{{b.pool, samples}}, rays);
  }
}

/// Fused stages: every path in flight gets `wave_rays` more rays. With `starts_paths` all of them
/// are new.
template <class Traits, class Source, class Executor>
void bounce_paths(Executor& execute, const WaveBuffers& b, const StageContext<Source>& context,
                  bool starts_paths) {
  StageQueues paths = b.stage_queues(StageId::bounce, &b.counters->intersect, b.pool.tag);
  if (starts_paths) paths.input = StageInput::every_slot;
  execute.run(
      FollowPaths<Traits, Source>{context, StageId::bounce, b.policy.wave_rays, starts_paths},
      paths);
}

/// Follows the paths that begin_wave left over to their ends.
template <class Traits, class Source, class Executor>
void finish_paths(Executor& execute, const WaveBuffers& b, const StageContext<Source>& context) {
  StageQueues paths = b.stage_queues(StageId::finish, &b.counters->finish, b.pool.tag);
  for (std::uint32_t*& next : paths.next) next = nullptr;  // no stage follows
  constexpr std::uint32_t all_rays = ~0u;
  execute.run(FollowPaths<Traits, Source>{context, StageId::finish, all_rays}, paths);
}

}  // namespace pt
