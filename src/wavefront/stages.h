// The stages of the wavefront: each loads a slot, calls one transport function, stores, and tags the
// slot with the stage that it waits for next. `scene` lies where the device put it; `rank` is the
// place of the slot in the stage's queue.
#pragma once

#include "common/render/options.h"
#include "common/transport/generate_camera_path.h"
#include "common/transport/shade_any.h"
#include "wavefront/path_pool.h"

namespace pt {

/// The numbers of one wave, in the device's memory: no stage asks the host.
struct WaveCounters {
  std::uint32_t ready[2];   ///< compaction: slots with a ray to trace, free slots
  std::uint32_t shade[2];   ///< compaction: slots at a surface, slots that missed
  std::uint32_t shadow[2];  ///< compaction: slots with a shadow ray; unused
  std::uint32_t generate;   ///< paths that this wave starts
  std::uint32_t intersect;  ///< rays that this wave traces
  std::uint32_t first_path;  ///< number of the first path that this wave starts
  std::uint32_t next_path;   ///< paths started so far
  std::uint32_t ticket;      ///< paths handed out where no queue ranks the free slots
  std::uint32_t waves;
};

/// Decides how many free slots get a new path. Returns false when nothing is left to do.
/// Without regeneration the pool is filled again only when all of its paths have ended.
PT_HD bool begin_wave(WaveCounters& c, std::uint32_t path_count, bool regenerate) {
  const std::uint32_t live = c.ready[0], free = c.ready[1];
  const std::uint32_t remaining = path_count - c.next_path;
  c.generate = regenerate || live == 0 ? (free < remaining ? free : remaining) : 0;
  c.intersect = live + c.generate;
  c.first_path = c.next_path;
  c.next_path += c.generate;
  c.ticket = 0;
  if (c.intersect == 0) return false;
  ++c.waves;
  return true;
}

/// What every stage needs.
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
  const Color before = has_lights ? samples.samples[samples.number_of(path)].radiance : Color(0.0f);
  samples.store(path, add_rounded(before, radiance));
}

template <bool has_lights, class Source>
struct GeneratePaths {
  static constexpr StageId id = StageId::generate;
  static constexpr PathTag tag = PathTag::free;
  static constexpr bool traces_rays = false;
  StageContext<Source> context;

  PT_HD void operator()(const Scene& scene, std::uint32_t slot, std::uint32_t rank) const {
    const auto& [pool, samples, source, counters, ray_queue, max_depth] = context;
    if (ray_queue == nullptr) {
      rank = atomic_fetch_add(&counters->ticket, 1);
      if (rank >= counters->generate) return;
    } else {
      ray_queue[counters->ready[0] + rank] = slot;
    }
    const std::uint32_t number = counters->first_path + rank;
    const PathState path = samples.begin_path(number);
    const PathId id_of_path = samples.id_of(path);
    auto random = source.open(id_of_path);
    const Ray ray = generate_camera_path(scene, path, random.draw(scatter_block(0)));
    source.close(id_of_path, random);
    pool.template store_path<has_lights>(slot, ray, path);
    if constexpr (has_lights) samples.samples[number] = Sample{};
    pool.tag[slot] = PathTag::intersect;
  }
};

template <Accel accel, Branching branching>
struct IntersectRays {
  static constexpr StageId id = StageId::intersect;
  static constexpr PathTag tag = PathTag::intersect;
  static constexpr bool traces_rays = true;
  PathPool pool;

  PT_HD void operator()(const Scene& scene, std::uint32_t slot, std::uint32_t) const {
    const Hit hit = intersect_closest<accel>(scene, pool.load_ray(slot));
    pool.store_hit(slot, hit);
    const bool miss = branching == Branching::divergent && hit.is_miss();
    pool.tag[slot] = miss ? PathTag::miss : PathTag::surface;
  }
};

template <bool has_lights>
struct ShadeMiss {
  static constexpr StageId id = StageId::shade_miss;
  static constexpr PathTag tag = PathTag::miss;
  static constexpr bool traces_rays = false;
  PathPool pool;
  SampleBuffer samples;

  PT_HD void operator()(const Scene& scene, std::uint32_t slot, std::uint32_t) const {
    Ray ray;
    PathState path = pool.template load_path<false>(slot, ray);
    ++path.rays;
    end_path<has_lights>(samples, path, shade_miss(scene, ray, path));
    pool.tag[slot] = PathTag::free;
  }
};

template <bool has_lights, Branching branching, class Source>
struct ShadeSurface {
  static constexpr StageId id = StageId::shade_surface;
  static constexpr PathTag tag = PathTag::surface;
  static constexpr bool traces_rays = false;
  StageContext<Source> context;

  PT_HD void operator()(const Scene& scene, std::uint32_t slot, std::uint32_t) const {
    const auto& [pool, samples, source, counters, ray_queue, max_depth] = context;
    Ray ray;
    PathState path = pool.template load_path<has_lights>(slot, ray);
    const Hit hit = pool.load_hit(slot);
    ++path.rays;
    const PathId id_of_path = samples.id_of(path);
    auto random = source.open(id_of_path);
    const Vec4 u = random.draw(scatter_block(path.rays));
    const Vec4 light = has_lights ? random.draw(light_block(path.rays)) : Vec4(0.0f);
    source.close(id_of_path, random);

    const Scattering scattering =
        branching == Branching::reduced
            ? shade_any<has_lights>(scene, ray, hit, path, max_depth, u, light)
            : shade_surface<has_lights>(scene, ray, hit, path, max_depth, u, light);

    if constexpr (has_lights) {
      const bool asks = !is_black(scattering.shadow.radiance);
      if (asks) pool.store_shadow(slot, scattering.shadow, samples.number_of(path));
      pool.shadow_tag[slot] = asks ? PathTag::surface : PathTag::free;
    }
    if (scattering.alive) {
      if constexpr (has_lights) add_emitted(path, scattering.emitted);
      pool.template store_path<has_lights>(slot, scattering.ray, path);
    } else {
      end_path<has_lights>(samples, path, scattering.emitted);
    }
    pool.tag[slot] = scattering.alive ? PathTag::intersect : PathTag::free;
  }

 private:
  PT_HD void add_emitted(const PathState& path, const Color& emitted) const {
    if (is_black(emitted)) return;
    Color& radiance = context.samples.samples[context.samples.number_of(path)].radiance;
    radiance = add_rounded(radiance, emitted);
  }
};

template <Accel accel>
struct TraceShadowRays {
  static constexpr StageId id = StageId::shadow;
  static constexpr PathTag tag = PathTag::surface;  // of the shadow tags
  static constexpr bool traces_rays = true;
  PathPool pool;
  SampleBuffer samples;

  PT_HD void operator()(const Scene& scene, std::uint32_t slot, std::uint32_t) const {
    std::uint32_t number;
    const ShadowRay shadow = pool.load_shadow(slot, number);
    if (!intersect_shadow<accel>(scene, shadow)) {
      Color& radiance = samples.samples[number].radiance;
      radiance = add_rounded(radiance, shadow.radiance);
    }
    pool.shadow_tag[slot] = PathTag::free;
  }
};

}  // namespace pt
