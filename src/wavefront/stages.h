// The stages of the wavefront: each loads a slot, calls one transport function, stores, and says
// which stage the path waits for next. How it gets there is the schedule's affair.
#pragma once

#include "common/render/options.h"
#include "common/transport/generate_camera_path.h"
#include "common/transport/shade_any.h"
#include "wavefront/path_pool.h"
#include "wavefront/wave_counters.h"

namespace pt {

/// What a stage says of a slot that it has finished.
struct Next {
  PathTag tag;          ///< what the path waits for
  bool shadow = false;  ///< a shadow ray of it waits, too
};

/// Where the slots of a stage can go; a stage that does not send them says so because they are
/// queued already or wait for nothing.
struct StageOutcomes {
  PathTag tag[2];
  bool sends;
  bool casts_shadow_rays;
};

/// What the stages that begin and shade paths need. `rank` in their calls is the place of the slot
/// in the stage's queue.
template <class Source>
struct StageContext {
  PathPool pool;
  SampleBuffer samples;
  Source source;
  WaveCounters* counters;
  std::uint32_t* ray_queue;  ///< null: there are no queues (Compaction::none)
  std::uint32_t max_depth;
};

/// Ends a path: its sample gets the last radiance and the path's counts. Without lights nothing has
/// been added before, and the sample need not be read.
template <bool has_lights>
PT_HD void end_path(const SampleBuffer& samples, const PathState& path, const Color& radiance) {
  const Color before = has_lights ? samples.samples[path.number].radiance : Color(0.0f);
  samples.store(path, add_rounded(before, radiance));
}

template <bool has_lights, class Source>
struct GeneratePaths {
  static constexpr StageId id = StageId::generate;
  static constexpr PathTag tag = PathTag::free;
  static constexpr bool traces_rays = false;
  static constexpr StageOutcomes outcomes = {{PathTag::intersect}, false, false};
  StageContext<Source> context;

  PT_HD Next operator()(const Scene& scene, std::uint32_t slot, std::uint32_t rank) const {
    const auto& [pool, samples, source, counters, ray_queue, max_depth] = context;
    if (ray_queue == nullptr) {
      rank = atomic_fetch_add(&counters->ticket, 1);
      if (rank >= counters->generate) return {PathTag::free};
    } else {
      ray_queue[counters->live + rank] = slot;  // a new path takes part in this very wave
    }
    PathState path;
    path.number = counters->first_path + rank;
    const PathId id_of_path = samples.id_of(path.number);
    auto random = source.open(id_of_path);
    const Ray ray = generate_camera_path(scene, id_of_path.pixel, random.draw(scatter_block(0)));
    source.close(id_of_path, random);
    pool.store_path(slot, ray, path);
    if constexpr (has_lights) samples.store(path, Color(0.0f));
    return {PathTag::intersect};
  }
};

template <Accel accel, Branching branching>
struct IntersectRays {
  static constexpr StageId id = StageId::intersect;
  static constexpr PathTag tag = PathTag::intersect;
  static constexpr bool traces_rays = true;
  static constexpr StageOutcomes outcomes = {{PathTag::surface, PathTag::miss}, true, false};
  PathPool pool;

  PT_HD Next operator()(const Scene& scene, std::uint32_t slot, std::uint32_t) const {
    const Hit hit = intersect_closest<accel>(scene, pool.load_ray(slot));
    if (branching == Branching::divergent && hit.is_miss()) return {PathTag::miss};
    pool.store_hit(slot, hit);
    return {PathTag::surface};
  }
};

template <bool has_lights>
struct ShadeMiss {
  static constexpr StageId id = StageId::shade_miss;
  static constexpr PathTag tag = PathTag::miss;
  static constexpr bool traces_rays = false;
  static constexpr StageOutcomes outcomes = {{PathTag::free, PathTag::free}, true, false};
  PathPool pool;
  SampleBuffer samples;

  PT_HD Next operator()(const Scene& scene, std::uint32_t slot, std::uint32_t) const {
    Vec3 ray_direction;
    PathState path = pool.load_path(slot, ray_direction);
    ++path.rays;
    end_path<has_lights>(samples, path, shade_miss(scene, ray_direction, path));
    return {PathTag::free};
  }
};

template <bool has_lights, Branching branching, class Source>
struct ShadeSurface {
  static constexpr StageId id = StageId::shade_surface;
  static constexpr PathTag tag = PathTag::surface;
  static constexpr bool traces_rays = false;
  static constexpr StageOutcomes outcomes = {{PathTag::intersect, PathTag::free}, true, has_lights};
  StageContext<Source> context;

  PT_HD Next operator()(const Scene& scene, std::uint32_t slot, std::uint32_t) const {
    const auto& [pool, samples, source, counters, ray_queue, max_depth] = context;
    Ray ray;
    PathState path = pool.load_path(slot, ray);
    const Hit hit = pool.load_hit(slot);
    ++path.rays;
    const PathId id_of_path = samples.id_of(path.number);
    auto random = source.open(id_of_path);
    const Vec4 u = random.draw(scatter_block(path.rays));
    const Vec4 light = has_lights ? random.draw(light_block(path.rays)) : Vec4(0.0f);
    source.close(id_of_path, random);

    const Scattering scattering =
        branching == Branching::reduced
            ? shade_any<has_lights>(scene, ray, hit, path, max_depth, u, light)
            : shade_surface<has_lights>(scene, ray, hit, path, max_depth, u, light);

    const bool shadow = has_lights && !is_black(scattering.shadow.radiance);
    if (shadow) pool.store_shadow(slot, scattering.shadow, path.number);
    if (!scattering.alive) {
      end_path<has_lights>(samples, path, scattering.emitted);
      return {PathTag::free, shadow};
    }
    if (has_lights && !is_black(scattering.emitted)) add(path.number, scattering.emitted);
    pool.store_path(slot, scattering.ray, path);
    return {PathTag::intersect, shadow};
  }

 private:
  PT_HD void add(std::uint32_t number, const Color& radiance) const {
    Color& sum = context.samples.samples[number].radiance;
    sum = add_rounded(sum, radiance);
  }
};

template <Accel accel>
struct TraceShadowRays {
  static constexpr StageId id = StageId::shadow;
  static constexpr PathTag tag = PathTag::surface;  // of the shadow tags
  static constexpr bool traces_rays = true;
  static constexpr StageOutcomes outcomes = {{PathTag::free}, false, false};
  PathPool pool;
  SampleBuffer samples;

  PT_HD Next operator()(const Scene& scene, std::uint32_t slot, std::uint32_t) const {
    std::uint32_t number;
    const ShadowRay shadow = pool.load_shadow(slot, number);
    if (!intersect_shadow<accel>(scene, shadow)) {
      Color& sum = samples.samples[number].radiance;
      sum = add_rounded(sum, shadow.radiance);
    }
    return {PathTag::free};
  }
};

}  // namespace pt
