// The stages of the wavefront: each loads a slot, calls one transport function, stores, and returns
// the stage for which the path waits next. Compaction does the rest (compaction.h).
#pragma once

#include "common/block_wavefront/path_share.h"
#include "common/film/markov_chains.h"
#include "common/options/options.h"
#include "common/transport/follow_path.h"
#include "wavefront/pool/path_pool.h"
#include "wavefront/pool/wave_counters.h"

namespace pt {

/// What a stage returns for a slot that it has finished.
struct Next {
  StageId to;           ///< what the slot waits for
  bool shadow = false;  ///< a shadow ray of it waits, too
};

/// Where the slots of a stage can go; a stage that does not send them says so because they are
/// queued already or wait for nothing.
struct StageOutcomes {
  StageId to[2];
  bool sends;
  bool casts_shadow_rays;
  StageId more[2] = {StageId::idle, StageId::idle};  ///< of one that casts no shadow rays; or idle

  constexpr int extra() const { return (more[0] != StageId::idle) + (more[1] != StageId::idle); }
};

/// How a stage reads the spheres; where they may lie decides how many kernels it has.
enum class SphereAccess {
  once,  ///< from global memory
  scan,  ///< all of them for every ray: where --scene-memory says
};

/// What the stage runs as: one kernel may be several stages.
template <class Stage>
PT_HD StageId id_of(const Stage& stage) {
  if constexpr (requires { stage.as; }) {
    return stage.as;
  } else {
    return Stage::id;
  }
}

/// Most threads of a block on CUDA. Shading many kinds of lights and materials needs registers more
/// than occupancy (results/ has the measurement): with 512 they get 128.
template <class Traits>
inline constexpr int shading_block_max = Traits::lighting == Lighting::full ? 512 : 1024;

/// Where shading streams its results (PoolSink) fewer registers do: 96, so that 20 warps fit.
inline constexpr int streaming_block_max = 640;

/// Only brute force scans.
template <class Traits>
inline constexpr SphereAccess sphere_access =
    Traits::accel == Accel::brute&& Traits::geometry == Geometry::spheres_and_quads
        ? SphereAccess::scan
        : SphereAccess::once;

/// What the stages that begin and shade paths need. `rank` in their calls is the index of the slot
/// in the stage's queue.
template <class Source>
struct StageContext {
  PathPool pool;
  SampleBuffer samples;
  Source source;
  WaveCounters* counters;
  std::uint32_t* ray_queue;  ///< null: there are no queues
  PathSettings settings;
  PathSupply supply;
};

/// The camera ray of a path in a free slot. `has_motion`: as in Traits.
template <bool has_motion = false, class Source>
PT_HD void start_path(const Scene& scene, const StageContext<Source>& context, std::uint32_t slot,
                      std::uint32_t path_index) {
  const PathId id = context.samples.id_of(path_index);
  auto random = context.source.open(id);
  float time = 0.0f;
  if constexpr (has_motion) time = shutter_time(scene, id);
  const Ray ray = begin_path<has_motion>(scene, id, random, time);
  context.source.close(id, random);
  context.pool.store_new_path(slot, ray, path_index);
  if constexpr (carries_extra<Source>) context.pool.extra.begin(slot, path_index);
  if (context.pool.medium != nullptr) {
    PathState path;
    path.medium.id = static_cast<std::uint16_t>(scene.camera_medium_id);
    context.pool.store_medium(slot, path);
    context.pool.store_flight(slot, {});
  }
}

/// The sink (transport/path_step.h) of all stages: keeps a path in its slot of the pool, and its
/// radiance in its sample. Without lights nothing is added before a path ends, and its sample need
/// not be read. `streams`: takes results as shading finds them (StreamingShading), to shorten live
/// ranges.
template <bool streams = false, bool has_media = false>
struct PoolSink {
  const PathPool& pool;
  const SampleBuffer& samples;
  std::uint32_t slot;
  bool has_lights;
  Next next{free_slot};
  Color emitted = Color(0.0f);  ///< and not yet added

  PT_HD void emit(const PathState& path, const Color& radiance) {
    if constexpr (streams) {
      add_radiance(samples, path.index, radiance);
    } else {
      emitted = radiance;
    }
  }
  PT_HD void aim(const PathState& path, const ShadowRay& shadow) {
    pool.store_shadow_ray(slot, shadow, path);
  }
  PT_HD void cast(const PathState& path, const ShadowRay& shadow) {
    if constexpr (!streams) pool.store_shadow_ray(slot, shadow, path);
    if constexpr (has_media) {
      pool.store_shadow_radiance(slot, shadow, path);
    } else {
      pool.store_shadow_radiance(slot, shadow.radiance, path);
    }
    next.shadow = true;
  }
  PT_HD void continue_path(const PathState& path, const Ray& ray) {
    if (has_lights) add_radiance(samples, path.index, emitted);
    pool.store_path(slot, ray, path);
    if constexpr (has_media) pool.store_medium(slot, path);
    next.to = StageId::intersect;
  }
  PT_HD void end(const PathState& path) {
    const Color before = has_lights ? samples.samples[path.index].radiance : Color(0.0f);
    samples.store(path, before + emitted);
  }
};

/// What a path carries, when it has been shaded: not before, since shading needs all registers.
template <bool carries>
PT_HD void carry_extra(const PathPool& pool, const SampleBuffer& samples, std::uint32_t slot,
                       const PathState& path, const Next& next) {
  if constexpr (carries) {
    if (next.to == StageId::intersect) return pool.extra.step(slot);
    if (!pool.extra.is_whole(slot, path)) samples.samples[path.index].radiance = broken_radiance();
  }
}

/// `has_motion`: as in Traits.
template <class Source, bool has_motion = false>
struct GeneratePaths {
  static constexpr StageId id = StageId::generate;
  static constexpr SphereAccess spheres = SphereAccess::once;
  static constexpr StageOutcomes outcomes = {{StageId::intersect}, false, false};
  StageContext<Source> context;
  bool has_lights;

  PT_HD Next operator()(const Scene& scene, std::uint32_t slot, std::uint32_t rank) const {
    WaveCounters* const counters = context.counters;
    if (context.ray_queue == nullptr) {
      rank = atomic_fetch_add(&counters->ticket, 1);
      if (rank >= counters->generate) return {free_slot};
    } else {
      // A new path takes part in this very wave.
      context.ray_queue[counters->first_ray + counters->live + rank] = slot;
    }
    const std::uint32_t path_index = counters->first_path + rank;
    start_path<has_motion>(scene, context, slot, path_index);
    if (has_lights) store_wide(&context.samples.samples[path_index], Sample{});
    return {StageId::intersect};
  }
};

/// Instead of GeneratePaths where paths repeat (PathSupply): a slot follows an index from path to
/// path, and when that has no more the next of its indices, which differ from the slot's by
/// multiples of `all_slots`. Slots whose indices are done wait for nothing.
template <class Source>
struct RepeatPaths {
  static constexpr StageId id = StageId::mutate;
  static constexpr SphereAccess spheres = SphereAccess::once;
  static constexpr StageOutcomes outcomes = {{StageId::intersect, free_slot}, true, false};
  StageContext<Source> context;
  std::uint32_t first_slot, all_slots;  ///< see WaveBuffers

  PT_HD Next operator()(const Scene& scene, std::uint32_t slot, std::uint32_t) const {
    const SampleBuffer& samples = context.samples;
    for (std::uint64_t index = first_slot + slot; index < samples.path_count; index += all_slots) {
      const auto path_index = static_cast<std::uint32_t>(index);
      if (context.supply.next(samples.samples, path_index)) {
        start_path(scene, context, slot, path_index);
        return {StageId::intersect};
      }
    }
    return {free_slot};
  }
};

/// What tracing depends on: scenes that differ in their light or in how grids are stored share its
/// kernels.
template <class T>
using RayTraits =
    Traits<T::accel, T::geometry, Lighting::sky, T::has_masks, T::has_media, false, T::has_motion>;

/// The same of shadow rays, which are attenuated by media.
template <class T>
using ShadowRayTraits = Traits<T::accel, T::geometry, Lighting::sky, T::has_masks, T::has_media,
                               T::has_sparse, T::has_motion>;

/// The next rays of paths: what is traced, and what becomes of a path when its hit is known.
struct PathRays {
  static constexpr StageId id = StageId::intersect;
  static constexpr StageOutcomes outcomes = {
      {StageId::shade_surface, StageId::shade_miss}, true, false};
  PathPool pool;
  bool parts_misses;  ///< false: a surface's stage shades them, too (Branching::reduced)

  PT_HD Next finish(std::uint32_t slot, const Hit& hit) const {
    if (parts_misses && hit.is_miss()) return {StageId::shade_miss};
    pool.store_hit(slot, hit);
    return {StageId::shade_surface};
  }
};

template <class Traits>
struct IntersectRays : PathRays {
  static constexpr SphereAccess spheres = SphereAccess::once;
  static constexpr StageOutcomes outcomes = {
      {StageId::shade_surface, StageId::shade_miss},
      true,
      false,
      {Traits::has_media ? StageId::sample_medium : StageId::idle, StageId::idle}};
  SampleBuffer samples;

  PT_HD Next operator()(const Scene& scene, std::uint32_t slot, std::uint32_t) const {
    if constexpr (Traits::has_media) {
      if (pool.load_flight(slot).has_begun()) return {StageId::sample_medium};  // its hit is known
    }
    std::uint32_t key = 0;
    if constexpr (Traits::has_masks) {
      const PathState path = pool.load_path_id(slot);
      key = next_ray_key(scene, path_hash<Traits>(scene, samples.id_of(path.index)), path.rays);
    }
    PathState timed;
    if constexpr (Traits::has_motion)
      set_time<Traits>(scene, samples.id_of(pool.load_path_id(slot).index), timed);
    Ray ray = pool.load_ray(slot);
    set_lanes(ray, pool.path_lanes(lanes_of(scene), slot));
    const Hit hit = intersect_closest<Traits>(scene, ray, key, timed.time);
    if constexpr (Traits::has_media) {
      if (pool.is_in_medium(slot)) {
        pool.store_hit(slot, hit);
        return {StageId::sample_medium};
      }
    }
    return finish(slot, hit);
  }
};

/// path_hash of scenes with media.
PT_HD std::uint32_t media_key(const Scene& scene, const SampleBuffer& samples,
                              std::uint32_t path_index) {
  using AnyWithMedia = Traits<Accel::brute, Geometry::mixed, Lighting::sky, true, true>;
  return path_hash<AnyWithMedia>(scene, samples.id_of(path_index));
}

/// The shading for which a path waits that has flown to `hit`.
PT_HD Next after_flight(const Hit& hit) {
  if (hit.is_collision()) return {StageId::shade_medium};
  return {hit.is_miss() ? StageId::shade_miss : StageId::shade_surface};
}

/// The free flights of paths in media: to a collision, or to what their rays have hit. One that is
/// not there after `collisions_max` null collisions goes on in the next wave. `has_sparse`: see
/// sample_grid().
template <bool has_sparse>
struct SampleMedium {
  static constexpr StageId id = StageId::sample_medium;
  static constexpr SphereAccess spheres = SphereAccess::once;
  static constexpr StageOutcomes outcomes = {{StageId::shade_surface, StageId::shade_miss},
                                             true,
                                             false,
                                             {StageId::shade_medium, StageId::intersect}};
  PathPool pool;
  SampleBuffer samples;
  std::uint32_t collisions_max;

  PT_HD Next operator()(const Scene& scene, std::uint32_t slot, std::uint32_t) const {
    Ray ray;
    PathState path = pool.load_path(slot, ray);
    set_lanes(ray, pool.path_lanes(lanes_of(scene), slot));
    pool.load_medium(slot, path);
    Hit hit = pool.load_hit(slot);
    FreeFlight flight = pool.load_flight(slot);
    const bool arrives = travel<has_sparse>(scene, ray, media_key(scene, samples, path.index),
                                            collisions_max, path, flight, hit);
    pool.store_path(slot, ray, path);
    pool.store_medium(slot, path);
    pool.store_flight(slot, arrives ? FreeFlight() : flight);
    if (!arrives) return {StageId::intersect};
    if (hit.is_collision()) pool.store_hit(slot, hit);
    return after_flight(hit);
  }
};

/// Routes each path whose flight has ended, where flights are taken to their ends by whole warps,
/// in the order of the queue.
struct RouteFlights {
  static constexpr StageId id = StageId::sample_medium;
  static constexpr SphereAccess spheres = SphereAccess::once;
  static constexpr const char* variant = "route";  ///< follows the stage's name
  static constexpr StageOutcomes outcomes = {{StageId::shade_surface, StageId::shade_miss},
                                             true,
                                             false,
                                             {StageId::shade_medium, StageId::idle}};
  PathPool pool;

  PT_HD Next operator()(const Scene&, std::uint32_t slot, std::uint32_t) const {
    return after_flight(pool.load_hit(slot));
  }
};

/// Routes each path whose ray has been traced to the stage that shades its hit or miss: for tracers
/// that store hits only (trace_rays in wavefront.h). One in a medium flies there first.
template <bool has_media>
struct RouteHits {
  static constexpr StageId id = StageId::route_hits;
  static constexpr SphereAccess spheres = SphereAccess::once;
  static constexpr StageOutcomes outcomes = {
      {StageId::shade_surface, StageId::shade_miss},
      true,
      false,
      {has_media ? StageId::sample_medium : StageId::idle, StageId::idle}};
  PathPool pool;

  PT_HD Next operator()(const Scene& scene, std::uint32_t slot, std::uint32_t) const {
    pool.path_lanes(lanes_of(scene), slot).count(LanePoint::route_hits);
    if constexpr (has_media) {
      if (pool.is_in_medium(slot)) return {StageId::sample_medium};
    }
    return {pool.load_hit(slot).is_miss() ? StageId::shade_miss : StageId::shade_surface};
  }
};

/// `lighting`: full or sky; the others differ from sky only in whether lights have added to a
/// sample. `carries`: see carry_extra.
template <Lighting lighting, bool carries>
struct ShadeMiss {
  static constexpr StageId id = StageId::shade_miss;
  static constexpr SphereAccess spheres = SphereAccess::once;
  static constexpr StageOutcomes outcomes = {{free_slot, free_slot}, true, false};
  PathPool pool;
  SampleBuffer samples;
  PathSettings settings;
  bool has_lights;

  PT_HD Next operator()(const Scene& scene, std::uint32_t slot, std::uint32_t) const {
    Ray ray;
    PathState path = lighting == Lighting::full ? pool.load_path(slot, ray)
                                                : pool.load_path(slot, ray.direction);
    ++path.rays;
    PoolSink<> sink{pool, samples, slot, has_lights};
    shade_miss<lighting>(scene, ray.direction, path, settings, sink);
    carry_extra<carries>(pool, samples, slot, path, sink.next);
    return sink.next;
  }
};

/// `streams`: see PoolSink.
template <class Traits, Branching branching, class Source, bool streams = false>
struct ShadeSurface {
  static constexpr bool has_lights = Traits::has_lights;
  static constexpr StageId id = StageId::shade_surface;
  static constexpr StageOutcomes outcomes = {{StageId::intersect, free_slot}, true, has_lights};
  static constexpr SphereAccess spheres = SphereAccess::once;
  static constexpr int block_max = streams ? streaming_block_max : shading_block_max<Traits>;
  StageContext<Source> context;

  PT_HD_IN_KERNEL Next operator()(const Scene& scene, std::uint32_t slot, std::uint32_t) const {
    const auto& [pool, samples, source, counters, ray_queue, settings, supply] = context;
    Ray ray;
    PathState path = pool.load_path(slot, ray);
    set_lanes(ray, lanes_of(scene).at(path.rays));
    if constexpr (Traits::has_media) pool.load_medium(slot, path);
    if constexpr (Traits::has_motion) set_time<Traits>(scene, samples.id_of(path.index), path);
    ++path.rays;
    const Hit hit = pool.load_hit(slot);
    PoolSink<streams, Traits::has_media> sink{pool, samples, slot, has_lights};
    if constexpr (streams) {
      const StreamingShading policy{source, samples, path, sink};
      shade_surface<Traits>(scene, ray, hit, path, settings, policy, sink);
    } else {
      const PathId id_of_path = samples.id_of(path.index);
      auto random = source.open(id_of_path);
      const EagerShading policy = eager_shading<Traits>(random, path);
      if constexpr (branching == Branching::reduced) {
        shade_without_branches<Traits>(scene, ray, hit, path, settings, policy, sink);
      } else {
        shade_surface<Traits>(scene, ray, hit, path, settings, policy, sink);
      }
      source.close(id_of_path, random);
    }
    carry_extra<carries_extra<Source>>(pool, samples, slot, path, sink.next);
    return sink.next;
  }
};

/// Collisions in media, as ShadeSurface does surfaces.
template <class Traits, class Source>
struct ShadeMedium {
  static constexpr StageId id = StageId::shade_medium;
  static constexpr StageOutcomes outcomes = {{StageId::intersect, free_slot}, true, true};
  static constexpr SphereAccess spheres = SphereAccess::once;
  static constexpr int block_max = shading_block_max<Traits>;
  StageContext<Source> context;

  PT_HD_IN_KERNEL Next operator()(const Scene& scene, std::uint32_t slot, std::uint32_t) const {
    const auto& [pool, samples, source, counters, ray_queue, settings, supply] = context;
    Ray ray;
    PathState path = pool.load_path(slot, ray);
    pool.load_medium(slot, path);
    set_time<Traits>(scene, samples.id_of(path.index), path);
    ++path.rays;
    PoolSink<false, true> sink{pool, samples, slot, true};
    const PathId id_of_path = samples.id_of(path.index);
    auto random = source.open(id_of_path);
    shade_medium<Traits>(scene, ray, pool.load_hit(slot).t, path, settings,
                         eager_shading<Traits>(random, path), sink);
    source.close(id_of_path, random);
    carry_extra<carries_extra<Source>>(pool, samples, slot, path, sink.next);
    return sink.next;
  }
};

/// Shadow rays, likewise.
struct ShadowRays {
  static constexpr StageId id = StageId::shadow;
  static constexpr StageOutcomes outcomes = {{free_slot}, false, false};
  PathPool pool;
  SampleBuffer samples;

  PT_HD Next finish(std::uint32_t path_index, const ShadowRay& shadow, bool is_occluded) const {
    if (!is_occluded) add_radiance(samples, path_index, shadow.radiance);
    return {free_slot};
  }
};

/// Dims shadow rays by the media in which they begin, and end, since every boundary there has a
/// BSDF and is opaque to them: for tracers that find occlusion only, on CUDA without sparse grids.
struct AttenuateShadowRays {
  static constexpr StageId id = StageId::shadow;
  static constexpr StageOutcomes outcomes = {{free_slot}, false, false};
  static constexpr SphereAccess spheres = SphereAccess::once;
  PathPool pool;
  SampleBuffer samples;

  PT_HD Next operator()(const Scene& scene, std::uint32_t slot, std::uint32_t) const {
    const std::uint16_t medium_id = pool.load_shadow_medium_id(slot);
    if (medium_id == no_medium) return {free_slot};
    std::uint32_t path_index;
    ShadowRay shadow = pool.load_shadow(slot, path_index);
    set_lanes(shadow.ray, pool.shadow_lanes(lanes_of(scene), slot));
    const std::uint32_t key =
        shadow_ray_key(scene, media_key(scene, samples, path_index), pool.load_shadow_rays(slot));
    pool.dim_shadow(
        slot, segment_transmittance<false>(scene, medium_id, shadow.ray, shadow.distance, key, 0));
    return {free_slot};
  }
};

template <class Traits>
struct TraceShadowRays : ShadowRays {
  static constexpr SphereAccess spheres = SphereAccess::once;

  PT_HD Next operator()(const Scene& scene, std::uint32_t slot, std::uint32_t) const {
    std::uint32_t path_index, key = 0;
    ShadowRay shadow = pool.load_shadow(slot, path_index);
    set_lanes(shadow.ray, pool.shadow_lanes(lanes_of(scene), slot));
    if constexpr (Traits::has_masks) {
      key = shadow_ray_key(scene, path_hash<Traits>(scene, samples.id_of(path_index)),
                           pool.load_shadow_rays(slot));
    }
    PathState timed;
    if constexpr (Traits::has_motion) set_time<Traits>(scene, samples.id_of(path_index), timed);
    if constexpr (Traits::has_media) {
      shadow.medium_id = pool.load_shadow_medium_id(slot);
      const Color passed = shadow_transmittance<Traits>(scene, shadow, key, timed.time);
      shadow.radiance *= passed;
      return finish(path_index, shadow, false);
    }
    return finish(path_index, shadow, intersect_shadow<Traits>(scene, shadow, key, timed.time));
  }
};

/// One thread follows a path for some rays and stores no hit in between. `bounce`: the fused stages
/// of a wave. `finish`: the last of a batch, where waves would cost more than what they do. It
/// always branches and traces shadow rays itself, as the serial mode does. Extra records stay in
/// the pool: a thread that follows a path for several rays changes them there for each.
template <class Traits, class Source>
struct FollowPaths {
  static constexpr bool has_lights = Traits::has_lights;
  static constexpr StageId id = StageId::bounce;
  static constexpr StageOutcomes outcomes = {{StageId::intersect, free_slot}, true, false};
  /// With the paper's generator they are in global memory alone (plan/kernels.h).
  static constexpr SphereAccess spheres =
      std::is_same_v<Source, PhiloxSource> ? sphere_access<Traits> : SphereAccess::once;
  static constexpr int block_max = shading_block_max<Traits>;
  StageContext<Source> context;
  StageId as;                 ///< bounce or finish
  std::uint32_t rays_max;     ///< that a path gets here, at least 1
  bool starts_paths = false;  ///< in free slots: their first rays are never stored

  PT_HD_IN_KERNEL Next operator()(const Scene& scene, std::uint32_t slot, std::uint32_t) const {
    const auto& [pool, samples, source, counters, ray_queue, settings, supply] = context;
    Ray ray;
    PathState path;
    if (starts_paths) {
      path.index = slot;  // the pool holds the whole batch
    } else {
      path = pool.load_path(slot, ray);
      if constexpr (Traits::has_media) pool.load_medium(slot, path);
    }
    const PathId id_of_path = samples.id_of(path.index);
    auto random = source.open(id_of_path);
    set_time<Traits>(scene, id_of_path, path);
    if (starts_paths) ray = begin_path<Traits::has_motion>(scene, id_of_path, random, path.time);
    if constexpr (carries_extra<Source>) {
      if (starts_paths) pool.extra.begin(slot, path.index);
    }
    set_lanes(ray, lanes_of(scene).at(path.rays));
    lanes_of(ray).count(as == StageId::bounce ? LanePoint::bounce : LanePoint::finish);
    Color radiance(0.0f);
    if (has_lights && !starts_paths) radiance = load_wide(&samples.samples[path.index]).radiance;
    const std::uint32_t key = path_hash<Traits>(scene, id_of_path);
    FreeFlight flight;
    if constexpr (Traits::has_media) {
      if (!starts_paths) flight = pool.load_flight(slot);
    }
    bool alive = true;
    for (std::uint32_t traced = 0; alive && traced < rays_max; ++traced) {
      alive = follow_ray<Traits>(scene, ray, path, radiance, settings, random, key, flight);
      flight = {};
      if constexpr (carries_extra<Source>) {
        if (alive) pool.extra.step(slot);
      }
    }
    source.close(id_of_path, random);
    if (!alive) {
      if constexpr (carries_extra<Source>) {
        if (!pool.extra.is_whole(slot, path)) radiance = broken_radiance();
      }
      samples.store(path, radiance);
      return {free_slot};
    }
    if (has_lights) store_wide(&samples.samples[path.index], Sample{radiance, 0});
    pool.store_path(slot, ray, path);
    if constexpr (Traits::has_media) pool.store_medium(slot, path);
    return {StageId::intersect};
  }
};

/// Puts the last paths of a batch where blocks follow them to their ends (block_wavefront.cuh).
template <bool carries>
struct HandOver {
  static constexpr StageId id = StageId::hand_over;
  static constexpr SphereAccess spheres = SphereAccess::once;
  static constexpr StageOutcomes outcomes = {{free_slot, free_slot}, false, false};
  PathPool pool;
  SampleBuffer samples;
  BegunPaths paths;

  PT_HD Next operator()(const Scene&, std::uint32_t slot, std::uint32_t rank) const {
    Ray ray;
    const PathState path = pool.load_path(slot, ray);
    const std::size_t place = paths.place(rank);
    paths.slots.paths[place].store_path(path, ray);
    paths.slots.paths[place].store_radiance(load_wide(&samples.samples[path.index]).radiance, path);
    if (paths.slots.media != nullptr) {
      store_wide(&paths.slots.media[place], load_wide(pool.at(pool.medium, slot)));
    }
    if constexpr (carries) pool.extra.copy_to(slot, paths.slots.extra, place);
    return {free_slot};
  }
};

}  // namespace pt
