// A path from a ray to its end: what one thread does that follows it alone.
#pragma once

#include "common/transport/extra_state.h"
#include "common/transport/path_step.h"

namespace pt {

/// Traces one ray of a path, shades its hit, and adds to the path's radiance. Returns whether
/// the path continues: `ray` is then its next one. `path_key` is path_hash(), `flight` where the
/// ray's has got already.
template <class Traits, class Stream>
PT_HD_IN_KERNEL bool follow_ray(const Scene& scene, Ray& ray, PathState& path, Color& radiance,
                                const PathSettings& settings, Stream& random,
                                std::uint32_t path_key, const FreeFlight& flight = {}) {
  const auto key = [&] { return path_key; };
  PathRegisters<Traits, decltype(key)> registers{scene, key, radiance, ray};
  const Hit hit = next_hit<Traits>(scene, ray, path_key, path, flight);
  ++path.rays;
  if (hit.is_miss()) {
    shade_miss<Traits::lighting>(scene, ray.direction, path, settings, registers);
  } else {
    shade_vertex<Traits>(scene, ray, hit, path, settings, eager_shading<Traits>(random, path),
                         registers);
  }
  return registers.alive;
}

/// Traces `ray` and what follows it. Returns the path's radiance: `radiance`, which it brings
/// along, and all that is added.
template <class Traits, class Stream>
PT_HD Color follow_path(const Scene& scene, Ray ray, PathState& path, Color radiance,
                        const PathSettings& settings, Stream& random, std::uint32_t path_key) {
  ExtraRegisters<extra_records_of<Stream>()> extra(settings);
  extra.begin(path.index);
  while (follow_ray<Traits>(scene, ray, path, radiance, settings, random, path_key)) extra.step();
  return extra.is_whole(path) ? radiance : broken_radiance();
}

}  // namespace pt
